"""From recordings of a real table to what the simulator gets wrong about it."""
