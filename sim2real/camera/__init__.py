"""Pictures with their times, from cameras, files and a renderer behind one interface.

`frame.py` defines a frame and a source; `sources.py` opens one by name, with the `settings.py` of a camera and its
`region.py` of interest. Cameras are in `live/`, and `camera_clock.py` ties their clocks to the host's. Played-back
sources share `playback.py` (`folder.py`, `video_file.py`, and `synthetic.py`, which renders the states of
`scene_states.py` with `render/`). `valid_frames.py` iterates over the frames that can be used, with the checks of
`frame_monitor.py`.
"""
