"""The gantry: what of the mallet's path its drive does not explain."""
