"""The arena: games in a browser, of people and players.

- `game`, `seats`: a match of one table, and who sits at it: a player by name, or a person's pointer.
- `ticking`: steps on absolute deadlines of a monotonic clock.
- `messages`: what a page may send, and what the server sends.
- `session`, `lobby`: a game with those who look on, and all of them, within limits.
- `recordings/`: every game becomes one, and any is shown beside the simulator.
- `server`: pages and WebSockets, for those who know the token; `page/`: what the browser runs.
"""
