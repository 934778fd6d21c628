"""Games of the arena as recordings, and recordings for its page."""
