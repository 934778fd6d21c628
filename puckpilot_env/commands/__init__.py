"""Sub-commands of `puckpilot` that need the simulator alone: each file has `add_arguments(parser)` and `run(args)`."""
