"""Commands of the topmost floor: those that need players and recordings."""
