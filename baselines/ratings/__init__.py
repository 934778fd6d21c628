"""Statistics of games: 95 % intervals of shares (`intervals`), and Elo ratings (`rating`), by Davidson's model."""
