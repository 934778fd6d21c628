"""Training players by self-play; the floor above `baselines`. Not built yet."""
