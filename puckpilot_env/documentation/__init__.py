"""The page of a variant: its facts, and how they are written."""
