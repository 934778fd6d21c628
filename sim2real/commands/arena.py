"""Play air hockey in a browser, watch players, or look at a recording beside the simulator.

With one player you play against it, with mouse, finger or arrow keys; your mallet has the limits of the gantry, and
friends can watch by a link of your page. With two they play, and you watch. With more they meet in turn, every two from
both seats, and the page shows ratings. Each game becomes a recording in --out, which its page can replay; puckpilot
tournament --played rates you. With the folder of a recording, of any table, you see it beside the simulator's
prediction; its page diagnoses it, and shows the prediction with what was found. With --concealed the table has an
effect for you to guess. The address that is printed holds a token, without which nobody gets in; the server listens on
this machine alone unless --host says otherwise.
"""

from __future__ import annotations

import argparse
import os
import re
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, NoReturn
from urllib.parse import quote

if TYPE_CHECKING:
    from aiohttp import web

    from sim2real.arena.lobby import Begin
    from sim2real.arena.recordings.records import Records

PORT = 8420
OPPONENT = "policy:champion"
MOST_PLAYERS = 16


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "players", nargs="*", metavar="PLAYER",
        help="one to play against (policy:champion), or those to watch; or the folder of a recording",
    )  # fmt: skip
    parser.add_argument("--seat", type=int, choices=(0, 1), help="yours (0, which is drawn at the left)")
    parser.add_argument("--host", default="127.0.0.1", metavar="HOST", help="to listen on (127.0.0.1)")
    parser.add_argument("--port", type=int, default=PORT, metavar="PORT", help=f"({PORT}); 0: any that is free")
    parser.add_argument("--out", type=Path, default=Path("out/arena"), metavar="DIR", help="for recordings (out/arena)")
    parser.add_argument("--name", default="guest", metavar="NAME", help="yours in records and ratings (guest)")
    parser.add_argument("--seed", type=int, default=0, metavar="SEED", help="of the games (0)")
    parser.add_argument(
        "--concealed", action="store_true",
        help="play on tables with an effect that is drawn by --seed, and shown once the recording is diagnosed",
    )  # fmt: skip
    parser.add_argument(
        "--quick",
        action="store_true",
        help="lift the gantry's limits: your mallet is four times as quick, and not rated",
    )
    parser.add_argument(
        "--diagnosis", type=Path, metavar="DIR", help="of the recording, as puckpilot diagnose --out DIR wrote it"
    )


def run(args: argparse.Namespace) -> NoReturn:
    """Serve until Ctrl-C, and say so by KeyboardInterrupt. ValueError, in one line, for an unknown player, a recording
    that cannot be read, or a port that is taken."""
    import secrets

    from puckpilot_env.options.inputs import seed_number, whole_number
    from sim2real.arena.game import PERSON, Game
    from sim2real.arena.lobby import Lobby
    from sim2real.arena.recordings.records import Records
    from sim2real.arena.server import make_app

    whole_number(args.port, "--port", 0, 65535)
    if not re.fullmatch(r"[\w-]{1,30}", args.name):
        raise ValueError(f"--name is {args.name!r}; expected up to 30 letters, digits, _ and -")
    recordings, names = _recordings(args.players), (PERSON, OPPONENT)
    diagnoses = _diagnoses(args.diagnosis, recordings)
    if recordings and (args.concealed or args.quick):
        option = "--concealed" if args.concealed else "--quick"
        raise ValueError(f"{option} is given with a recording; expected a player to play against")
    if not recordings:
        names = _seated(args.players or [OPPONENT], args.seat or 0)
        if PERSON not in names and (given := next((one for one in ("quick", "seat") if getattr(args, one)), None)):
            raise ValueError(f"--{given} is given where you do not play; expected one player to play against")
        for one in {names, *pairwise(args.players)}:
            Game(one, seed_number(args.seed), quick=args.quick).tick()  # compiles before anyone waits for it
    token, records = secrets.token_urlsafe(12), Records(args.out, recordings, args.name)
    app = make_app(Lobby(names, args.seed, records, _begin(args, names, records)), records, token, diagnoses)
    page = f"replay?name={quote(recordings[0].resolve().name)}&token={token}" if recordings else f"?token={token}"
    raise KeyboardInterrupt(_serve(app, args.host, args.port, page))


def _recordings(given: list[str]) -> list[Path]:
    """The recording that is given in place of players, if one is. ValueError, in one line, if it cannot be shown, or a
    folder is none."""
    from sim2real.recording.folder import read_recording

    folders = [Path(name) for name in given if os.sep in name or (Path(name) / "meta.json").exists()]
    found = [folder for folder in folders if folder.is_dir()]
    if missing := [one for one in folders if not (one.exists() or one.suffix or ":" in str(one))]:
        raise ValueError(f"there is no folder '{missing[0]}'; expected the folder of a recording, or a player's name")
    if found and len(given) > 1:
        raise ValueError(f"{len(given)} are given, with the recording {found[0]}; expected one recording alone")
    for recording in found:
        read_recording(recording)
    return found


def _diagnoses(folder: Path | None, recordings: list[Path]) -> dict[str, Path]:
    """The diagnosis that is given, by the name of its recording. ValueError, in one line, if it cannot be shown."""
    from sim2real.arena.recordings.found import read_diagnosis

    if folder is None:
        return {}
    if not recordings:
        raise ValueError("--diagnosis is given without a recording; expected puckpilot arena RECORDING --diagnosis DIR")
    read_diagnosis(folder)
    return {recordings[0].resolve().name: folder}


def _seated(players: list[str], seat: int) -> tuple[str, str]:
    """Who plays first: two players, or a person at the `seat` and one player. ValueError, in one line, for an unknown
    one, and for more that cannot meet."""
    from baselines import find_player
    from sim2real.arena.game import PERSON

    if len(players) > MOST_PLAYERS:
        raise ValueError(f"{len(players)} players are given; expected {MOST_PLAYERS} at most")
    for name in players:
        find_player(name)
    if len(players) > 2 and len(set(players)) < len(players):
        raise ValueError(f"players are {', '.join(players)}; expected each named once where more than two meet")
    if len(players) >= 2:
        return players[0], players[1]
    return (PERSON, players[0]) if seat == 0 else (players[0], PERSON)


def _begin(args: argparse.Namespace, names: tuple[str, str], records: Records) -> Begin:
    """What makes the session of a game; of more than two players one that goes on from match to match, to which those
    in the folder of `records` count. ValueError, in one line, if its file of them is none."""
    from baselines.matches.played_games import read_games
    from sim2real.arena.game import Game, concealed_game
    from sim2real.arena.recordings.records import GAMES
    from sim2real.arena.session import Session
    from sim2real.arena.tournament.standings import among
    from sim2real.arena.tournament.tour import Tour

    if len(args.players) <= 2:
        make_game = partial(concealed_game if args.concealed else Game, quick=args.quick)
        return lambda seed, lateness: Session(names, seed, records, lateness, make_game)
    if args.concealed:
        raise ValueError(f"--concealed is given with {len(args.players)} players; expected one to play against, or two")
    file = records.folder / GAMES
    games = among(args.players, read_games(file)) if file.exists() else []
    return lambda _, lateness: Tour(args.players, games, args.seed, records, lateness)


def _serve(app: web.Application, host: str, port: int, page: str) -> int:
    """Serve, and print a page's address; the signal that ended it. ValueError, in one line, if it cannot listen."""
    import asyncio

    from sim2real.arena.server import serve
    from sim2real.arena.ticking import avoid_pauses

    avoid_pauses()

    def say(port: int) -> None:
        print(f"http://{f'[{host}]' if ':' in host else host}:{port}/{page}    Ctrl-C ends", flush=True)

    try:
        return asyncio.run(serve(app, host, port, say))
    except OSError as error:
        number = error.errno or 0  # asyncio's own words are long; negative ones are of names
        why = os.strerror(number) if number > 0 else error.strerror
        raise ValueError(f"cannot listen on {host}:{port}: {why}; give another --host or --port") from None
