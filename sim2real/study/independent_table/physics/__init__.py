"""The physics of the independent table, in small fixed steps."""
