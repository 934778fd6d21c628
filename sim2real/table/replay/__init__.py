"""A recording as a table: what was seen is seen again, and plans go nowhere."""
