"""From pictures and table.json to the states of puck and opponent.

The path of a frame: `tracker.py` locates the camera in the first picture and turns frames into a recording;
`detector.py` asks `kalman_tracker.py` where puck and opponent should be, `search/` where that is in the
picture, and `blobs.py` what shines there; `subpixel_edges.py` finds the exact edges of a blob on the table; `disc.py`
fits the puck's rim to them (`puck.py` decides whether it is the puck), `concentric_circles.py` the opponent's ring
(`ring.py`). The Kalman tracker filters the measurements. `camera_shift.py` notices a camera that was moved, and
`preview.py` draws what was found.
"""
