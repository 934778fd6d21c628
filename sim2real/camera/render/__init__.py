"""Synthetic pictures of a table, geometrically exact to a few micrometres: the ground truth for tests of the vision.

The path of a picture: `scene_state.py` says where puck and mallets are, `table.py` and `view.py` what the table and the
camera are; `background.py` draws what stands still and `bodies.py` what moves, as shapes (`paint.py`) whose coverage of
each pixel is computed exactly (`coverage.py`); `sensor.py` adds blur, noise and rounding; `renderer.py` joins it all
and draws anew only the boxes (`box.py`) in which something moves.
"""
