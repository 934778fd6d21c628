"""One file, one player: a subclass of `baselines.player.Player`. Dropping a file here registers it."""
