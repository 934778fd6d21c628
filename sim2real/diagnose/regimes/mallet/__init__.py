"""Contacts with the robot's mallet."""
