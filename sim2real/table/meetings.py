"""Games at a table, resumable: how they end, how long they take, and recordings of them. On the twin several are played
at once; at a physical table a person sits at the other end, and they are played in turn."""

from __future__ import annotations

import functools
import json
import shutil
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import closing, nullcontext
from dataclasses import asdict, dataclass, field, replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np

import sim2real
from puckpilot_env.files.whole_file import write_text_whole
from puckpilot_env.variants import find_variant
from sim2real.study.version import OF_GAMES, code_version
from sim2real.table.faults import TableFaultError
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.play import play_for, play_game
from sim2real.table.game.robot_seat import RobotSeat, make_robot_seat
from sim2real.table.game.shots import Shots
from sim2real.table.player_file import player_digest
from sim2real.table.recorder.draft import draft_of
from sim2real.table.recorder.recorded_game import recorded
from sim2real.table.twin.concealed import find_table
from sim2real.table.twin.plant import Plant
from sim2real.table.twin.twin import Twin

FORMAT = "puckpilot-meeting/2"
WARM = 0.3  # s of a game before the first one that is timed, in which all is compiled
Onlooker = Callable[[Plant, np.void], None]
ROOT = Path(sim2real.__file__).parents[1]  # of the checkout whose code plays


@dataclass(frozen=True)
class Meeting:
    """Who meets: `player` at the robot's seat, its `opponent`, the `variant`'s id, and the game's `seed`.

    seconds: of play at most; None for a whole game. again: whether another game begins where one ends within them.
    camera: the kind of the twin's, see `cameras.CAMERAS`. concealed: the twin's table, see `concealed.TABLES`; "" for
    the simulator's. clears: whether play goes on after a doubt stopped the twin. recorded: whether the game is
    recorded, as `recordings/game_SEED` beside its result. camera_delay, command_delay: that the loop allows for [s],
    None for what a table.toml states. table: the table.toml of a physical table, where a person is the opponent, and is
    asked whether play goes on; "" for the twin.
    """

    player: str
    opponent: str
    variant: str
    seed: int
    seconds: float | None = None
    camera: str = "places"
    again: bool = False
    concealed: str = ""
    clears: bool = False
    recorded: bool = False
    camera_delay: float = 0.0
    command_delay: float | None = None
    table: str = ""


@dataclass(frozen=True)
class PlayedMeeting:
    """What came of a game, or of several: outcome 1, 0, -1 as the player won, drew or lost; goals of both; `seconds` of
    play.

    virtual: the twin's time from power-on to the end, the physical table's from the face-off on [s]; processor, wall:
    what it took on this computer [s]; stops: how often a doubt stopped the table; shots: at both goals, as the robot's
    camera saw them; opponent: by name.
    """

    outcome: int
    goals: tuple[int, int]
    seconds: float
    virtual: float
    processor: float
    wall: float
    stops: int = 0
    shots: Shots = field(default_factory=Shots)
    opponent: str = ""


def play_meeting(meeting: Meeting, recording: Path | None, onlooker: Onlooker | None = None) -> PlayedMeeting:
    """Play a game, recorded as a new folder if one is given. ValueError, in one line, for an unknown name, and where
    the table stopped.

    onlooker: takes the twin's plant as it is, and the game's record, at each frame of the camera."""
    if not meeting.table:
        _warm_up(replace(meeting, seed=0, seconds=WARM))
    return _play(meeting, recording, onlooker)


@functools.cache
def _warm_up(meeting: Meeting) -> None:
    _play(meeting, None)


def _play(meeting: Meeting, recording: Path | None, onlooker: Onlooker | None = None) -> PlayedMeeting:
    begin = time.process_time(), time.perf_counter()
    with closing(_seat(meeting)) as env:
        if onlooker:
            assert isinstance(env.backend, Twin)
            env.backend.onlooker = lambda plant: onlooker(plant, env.game.record)
        where = meeting.table or "the twin"
        note = f"{meeting.player} against {meeting.opponent} on {where}, seed {meeting.seed}"
        with nullcontext() if recording is None else recorded(env, recording, note):
            given = env, meeting.player, meeting.seed
            said = *_spoken(meeting), (lambda loop, action, info: None)
            if meeting.again and meeting.seconds is not None:
                log = play_for(*given, meeting.seconds, *said).complete
            else:
                log = play_game(*given, meeting.seconds, *said).complete
            if log.interrupted:
                raise KeyboardInterrupt
            on_table = log.table_seconds if meeting.table else env.backend.now()
    processor, wall = time.process_time() - begin[0], time.perf_counter() - begin[1]
    return PlayedMeeting(
        log.outcome, log.score, log.seconds, on_table, processor, wall, len(log.faults), log.shots, meeting.opponent
    )


def _seat(meeting: Meeting) -> RobotSeat:
    variant = find_variant(meeting.variant)
    delays = {"camera_delay": meeting.camera_delay, "command_delay": meeting.command_delay}
    if meeting.table:
        return make_robot_seat(variant, "table", **delays, table=meeting.table)
    options = find_table(meeting.concealed).twin_options(GameRecord(variant).p) if meeting.concealed else {}
    options |= {"opponent": meeting.opponent, "camera": meeting.camera}
    return make_robot_seat(variant, "twin", **delays, **options)


def _spoken(meeting: Meeting) -> tuple[Callable[[str], None], Callable[[TableFaultError], bool]]:
    """What takes a line for each goal, foul and fault, and whether play goes on after a fault: the person at a physical
    table is asked."""
    if meeting.table:
        from sim2real.table.physical.person import may_go_on, say  # a terminal of Unix

        return say, may_go_on
    return (lambda line: None), (lambda fault: meeting.clears)


def play_all(
    meetings: list[Meeting], folder: Path, processes: int, progress: Callable[[int, int], None]
) -> list[PlayedMeeting]:
    """Play the games whose results are not in `folder` yet, and return all of them, in the order of `meetings`.

    Each result is written there as soon as its game is over. ValueError, in one line, for a file of another meeting,
    of a player that has changed since, wherever it lies, or of another version of the code. Games at a
    physical table are played in turn, and kept whatever the version.
    """
    code = code_version(ROOT, OF_GAMES)
    missing = [one for one in meetings if _read(folder, one, code) is None]
    for done, _ in enumerate(_results(missing, folder, code, processes), len(meetings) - len(missing) + 1):
        progress(done, len(meetings))
    return kept_games(meetings, folder)


def kept_games(meetings: list[Meeting], folder: Path) -> list[PlayedMeeting]:
    """The games of `meetings` whose results are in `folder`, in their order. ValueError as of `play_all`."""
    code = code_version(ROOT, OF_GAMES)
    return [game for one in meetings if (game := _read(folder, one, code)) is not None]


def _results(missing: list[Meeting], folder: Path, code: str, processes: int) -> Iterator[None]:
    if processes == 1 or len(missing) < 2 or any(one.table for one in missing):
        yield from (_play_and_write(one, folder, code) for one in missing)
        return
    with ProcessPoolExecutor(processes, mp_context=get_context("spawn")) as pool:
        coming = [pool.submit(_play_and_write, one, folder, code) for one in missing]
        try:
            yield from (one.result() for one in as_completed(coming))
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _file(folder: Path, meeting: Meeting) -> Path:
    return folder / f"game_{meeting.seed}.json"


def _recording(folder: Path, meeting: Meeting) -> Path | None:
    """Where a game is recorded. What an interrupted one left there is removed."""
    if not meeting.recorded:
        return None
    path = folder / "recordings" / f"game_{meeting.seed}"
    for left in (path, draft_of(path)):
        shutil.rmtree(left, ignore_errors=True)
    return path


def _play_and_write(meeting: Meeting, folder: Path, code: str) -> None:
    game = asdict(play_meeting(meeting, _recording(folder, meeting)))
    kept = {"code": code, "player": player_digest(meeting.player), "meeting": asdict(meeting)}
    content = {"format": FORMAT, **kept, "game": game}
    write_text_whole(_file(folder, meeting), json.dumps(content, indent=1) + "\n")


def _read(folder: Path, meeting: Meeting, code: str) -> PlayedMeeting | None:
    path = _file(folder, meeting)
    if not path.exists():
        return None
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content["format"] != FORMAT or replace(Meeting(**content["meeting"]), player=meeting.player) != meeting:
            raise ValueError
        player = content["player"]
        read = {"goals": tuple(content["game"]["goals"]), "shots": Shots(**content["game"]["shots"])}
        game = PlayedMeeting(**content["game"] | read)
    except (ValueError, KeyError, TypeError):
        raise ValueError(f"{path}: is no result of this meeting; name another folder, or remove it") from None
    if player != player_digest(meeting.player):
        raise ValueError(
            f"{path}: was played by another player than {meeting.player}; name another folder, or remove it"
        )
    if content.get("code") != code and not meeting.table:
        raise ValueError(f"{path}: was played by another version of the code; name another folder, or remove it")
    return game
