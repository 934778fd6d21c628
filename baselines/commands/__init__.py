"""Sub-commands of `puckpilot` that need players: each file has `add_arguments(parser)` and `run(args)`."""
