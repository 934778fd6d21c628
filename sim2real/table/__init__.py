"""A table behind the simulator's interface: what a policy does there, step by step.

    action -> mallet_driver (the simulator's plan, a trajectory) -> backend (the board's line, or a twin's)
    backend -> frames and telemetry -> moving_objects (estimates) -> referee (rules) -> robot_seat (observation)

- `backend`: what a table is to its player; `backends`: those known by name.
- `robot_seat`: the robot's seat at a backend as a Gymnasium environment.
- `board_line`: greeting, configuration, homing, arming and trajectories through a session with the board.
- `twin`: a table on a laptop: the flashed firmware in the emulator, an independent plant, a camera's measured places.
"""
