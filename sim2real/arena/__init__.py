"""The arena: games in a browser, of people and players.

- `game`, `seats`: a match of one table, and who sits at it: a player by name, or a person's pointer; `quick_mallet`:
  without the gantry's limits.
- `ticking`: steps on absolute deadlines of a monotonic clock; `health`: how late they were.
- `messages`: what a page may send, and what the server sends.
- `session`, `listener`, `lobby`: a game, the pages that see it, and all games, within limits.
- `recordings/`: every game becomes one, and any is shown beside the simulator, diagnosed, and filmed.
- `concealed`: tables with an effect for a person to guess.
- `tournament/`: several players meet in turn.
- `watching/`: a game at a twin or a physical table, watched in a browser.
- `access`, `door`: who comes in, and how much they may say.
- `bench/`: how quick all that is.
- `server`: pages and WebSockets, for those who know the token; `page/`: what the browser runs.
"""
