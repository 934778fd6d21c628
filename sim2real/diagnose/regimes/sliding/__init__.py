"""The sliding puck between two contacts."""
