"""What a recording shows beside what the simulator predicts, segment by segment."""
