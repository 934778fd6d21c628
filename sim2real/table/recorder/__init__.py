"""Recordings of a table: what passes between host and table, kept as it comes, with programs that excite it."""
