"""Games of the arena as recordings, and recordings, with their diagnoses, for its page."""
