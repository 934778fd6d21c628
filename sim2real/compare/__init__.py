"""Compare a recording with the simulator's predictions, segment by segment."""
