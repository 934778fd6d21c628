"""From photographs of a table to table.json: camera poses, markers, surface and coordinate warp (report B).

The path of a calibration: `calibration_view.py` reads a folder with a photograph and hand-measured points;
`input_checks.py` refuses points that cannot be right; `initial_guess.py` starts from a flat table; `multiview.py`
adjusts all views at once (a bundle adjustment), with the residuals of `residuals.py` and the robust least squares of
`robust_fit.py`; `width_check.py` and `place_uncertainty.py` tell whether the points agree on the table's width and
cover it; `holdout_view.py` tests the result on an unused view; `table_file.py` and `residual_plot.py` write it.
`pose.py` finds a camera over a calibrated table; `intrinsics/` calibrates the camera itself.
"""
