"""Identify the constants of a table from its recordings: a fit with intervals, and a profile that others load."""
