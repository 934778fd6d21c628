"""Commands of `puckpilot` about learning players."""
