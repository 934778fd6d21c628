"""Fault drills at the twin: something goes wrong in the middle of play, and the mallet has to stop.

- `faults`: what can go wrong, a row each; `monitor`: where the mallet is and how fast, in the plant's own truth;
- `drill`: plays, lets a fault happen, measures, mends, clears and plays on.
"""
