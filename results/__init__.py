"""Published figures: which commands they come from, the outputs that are kept, and whether the documents agree."""
