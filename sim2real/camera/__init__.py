"""Pictures with their times, from cameras, files and a renderer behind one interface.

`frame.py` defines a frame and a source; `sources.py` opens one by name. Live sources share `live.py` (`device.py`,
`aravis.py`, `flir.py`), played-back ones `playback.py` (`folder.py`, `video_file.py`, and `synthetic.py`, which renders
the states of `scene_states.py` with `render/`). `valid_frames.py` iterates over the frames that can be used, with the
checks of `frame_monitor.py`.
"""
