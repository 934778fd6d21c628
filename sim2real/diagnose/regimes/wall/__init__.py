"""Contacts with walls and posts."""
