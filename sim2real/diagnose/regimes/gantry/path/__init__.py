"""The path that the motors' volts cause: modes of an axis, belt and gap, and what dry friction changes."""
