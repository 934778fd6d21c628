"""The result of a diagnosis as data."""
