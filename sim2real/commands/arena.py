"""Play air hockey in a browser, or watch two players.

With one player you play against it, with mouse, finger or arrow keys; your mallet has the limits of the gantry. With
two they play, and you watch. The address that is printed holds a token, without which nobody gets in; the server
listens on this machine alone unless --host says otherwise.
"""

from __future__ import annotations

import argparse
from typing import NoReturn

PORT = 8420


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("players", nargs="*", metavar="PLAYER", help="one to play against (policy:champion), or two")
    parser.add_argument("--seat", type=int, choices=(0, 1), default=0, help="yours (0, which is drawn at the left)")
    parser.add_argument("--host", default="127.0.0.1", metavar="HOST", help="to listen on (127.0.0.1)")
    parser.add_argument("--port", type=int, default=PORT, metavar="PORT", help=f"({PORT}); 0: any that is free")
    parser.add_argument("--seed", type=int, default=0, metavar="SEED", help="of the games (0)")


def run(args: argparse.Namespace) -> NoReturn:
    """Serve until Ctrl-C, and say so by KeyboardInterrupt. ValueError, in one line, for an unknown player or a port
    that is taken."""
    import asyncio
    import os
    import secrets

    from baselines import find_player
    from puckpilot_env.options.inputs import seed_number, whole_number
    from sim2real.arena.game import PERSON, Game
    from sim2real.arena.lobby import Lobby
    from sim2real.arena.server import make_app, serve

    whole_number(args.port, "--port", 0, 65535)
    players = args.players or ["policy:champion"]
    if len(players) > 2:
        raise ValueError(f"{len(players)} players are given; expected one to play against, or two to watch")
    for name in players:
        find_player(name)
    names = (players[0], players[1]) if len(players) == 2 else (PERSON, players[0])
    if len(players) == 1 and args.seat == 1:
        names = (players[0], PERSON)
    Game(names, seed_number(args.seed)).tick()  # compiles before anyone waits for it
    token = secrets.token_urlsafe(12)
    app = make_app(Lobby(names, args.seed), token)

    def say(port: int) -> None:
        host = f"[{args.host}]" if ":" in args.host else args.host
        print(f"http://{host}:{port}/?token={token}    Ctrl-C ends", flush=True)

    try:
        ended_by = asyncio.run(serve(app, args.host, args.port, say))
    except OSError as error:
        number = error.errno or 0  # asyncio's own words are long; negative ones are of names
        why = os.strerror(number) if number > 0 else error.strerror
        raise ValueError(f"cannot listen on {args.host}:{args.port}: {why}; give another --host or --port") from None
    raise KeyboardInterrupt(ended_by)
