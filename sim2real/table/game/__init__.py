"""A game at a table: the loop from frames to plans, the rules on what is seen, and its environments.

- `loop`: estimates (`moving_objects`), plans, rules (`referee`) on the simulator's record (`game_record`);
- `robot_seat`: the robot's seat as a Gymnasium environment; `two_seats`: both seats in PettingZoo's form;
- `seated_player`: the player, unless it was trained for another game;
- `play`: whole games, what came of them (`game_log`, `loop_times`), and a `view` of them.
"""
