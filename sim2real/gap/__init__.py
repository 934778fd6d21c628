"""What a table's unmodelled physics costs a player, and how much of it is won back: play, diagnose, fine-tune, play."""
