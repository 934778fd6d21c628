"""The accuracy and speed of the vision, measured on rendered pictures: `rendered_calibration.py` makes calibrations of
a rendered table, `bench.py` measures with them, `baseline.py` has the methods that the disc fit is compared with."""
