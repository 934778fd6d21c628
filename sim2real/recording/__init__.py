"""Read, check and write recordings of a table."""
