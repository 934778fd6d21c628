"""The puck between two contacts: friction, drag and forces."""
