"""Cameras that run at their own rate.

`live_source.py` keeps the newest picture of each; `aravis.py` and `flir.py` set a GenICam camera's features by
`genicam.py`, and `device.py` opens what OpenCV can.
"""
