"""PettingZoo and Gymnasium interfaces over `puckpilot_env.tables`."""
