"""Statistics that do not depend on air hockey."""
