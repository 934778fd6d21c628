"""Recordings of a table: read strictly, checked, written whole."""
