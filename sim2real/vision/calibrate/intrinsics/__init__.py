"""A camera's intrinsics from photographs of a flat board: `board.py` finds the corners, `calibrate.py` fits the
intrinsics, and `case_deletion.py` tells how certain they are and which photograph the others contradict."""
