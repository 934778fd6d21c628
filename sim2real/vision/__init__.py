"""From photographs to positions on the table in metres.

The path of a pixel: `markers.py` finds the markers round the table in a photograph and `edges.py` refines their
corners; `camera.py` (the pinhole model with distortion), `motion.py` (the camera's pose), `surface.py` (the table's
curved surface) and `coordinate_warp.py` (hand-measured against rigid coordinates) are the measurement model;
`table_geometry.py` joins the last two with the markers; `locate.py` inverts the model, from pixels to the table.
`calibrate/` estimates the model from photographs, `track/` uses it on every frame, `trial/` measures both on rendered
pictures. `camera_file.py` and `json_file.py` read and write the calibration's files; `target_ranges.py` checks what a
user says of puck and ring.
"""
