"""Play at the ends of all ranges against players that press, and invariants that hold after every step."""
