"""A game that is played elsewhere, at a twin or a physical table, watched in a browser.

- `live_view`: what the robot's side knows of a game, as the arena's messages; and the pace of a twin that is watched.
- `feed`: hands them over to a process of its own, without ever waiting for it.
- `relay`: that process, a server of the arena; `broadcast` passes all that comes on to the pages.
"""
