"""Games on a twin whose physics is concealed, in parallel and resumable: the score, and the recordings of that play."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import closing, nullcontext
from dataclasses import asdict, dataclass
from multiprocessing import get_context
from pathlib import Path

import sim2real
from puckpilot_env.files.whole_file import write_text_whole
from puckpilot_env.variants import find_variant
from sim2real.gap.concealed import find_table
from sim2real.study.version import OF_GAMES, code_version
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.play import play_game
from sim2real.table.game.robot_seat import make_robot_seat
from sim2real.table.recorder.recorded_game import recorded

FORMAT = "puckpilot-gap-game/1"
ROOT = Path(sim2real.__file__).parents[1]  # of the checkout whose code plays


@dataclass(frozen=True)
class Meeting:
    """A player, by name, at the robot's seat of the concealed `table`, against the hand of an `opponent`.

    seed: of the game; seconds: of play at most.
    """

    player: str
    opponent: str
    table: str
    variant: str
    seed: int
    seconds: float


@dataclass(frozen=True)
class Game:
    """goals: of the robot and its opponent; seconds: of play; stops: how often a doubt stopped the table."""

    seed: int
    goals: tuple[int, int]
    seconds: float
    stops: int


def play_all(
    meetings: Sequence[Meeting], folder: Path, recordings: Path | None, processes: int,
    progress: Callable[[int, int], None],
) -> list[Game]:  # fmt: skip
    """Play the games whose results are not in `folder` yet; all of them, in the order of `meetings`.

    recordings: where each is recorded too, as `game_SEED`. ValueError, in one line, for a result of something else.
    """
    folder.mkdir(parents=True, exist_ok=True)
    done = {one: _read(folder, one) for one in meetings}
    missing = [one for one, game in done.items() if game is None]
    progress(len(meetings) - len(missing), len(meetings))
    if missing:
        with ProcessPoolExecutor(min(processes, len(missing)), mp_context=get_context("spawn")) as pool:
            coming = {pool.submit(_play_and_write, one, folder, recordings): one for one in missing}
            try:
                for number, result in enumerate(as_completed(coming), len(meetings) - len(missing) + 1):
                    done[coming[result]] = result.result()
                    progress(number, len(meetings))
            finally:
                pool.shutdown(wait=True, cancel_futures=True)
    return [game for game in done.values() if game is not None]


def _play_and_write(meeting: Meeting, folder: Path, recordings: Path | None) -> Game:
    game = play(meeting, None if recordings is None else recordings / f"game_{meeting.seed}")
    content = {"format": FORMAT, "code": code_version(ROOT, OF_GAMES), "meeting": asdict(meeting), "game": asdict(game)}
    write_text_whole(_file(folder, meeting), json.dumps(content, indent=1) + "\n")
    return game


def play(meeting: Meeting, recording: Path | None) -> Game:
    """Play a game, recorded as a new folder if one is given. ValueError, in one line, where the table stopped."""
    variant = find_variant(meeting.variant)
    options = find_table(meeting.table).twin_options(GameRecord(variant).p)
    with closing(make_robot_seat(variant, "twin", opponent=meeting.opponent, **options)) as env:
        note = f"puckpilot gap, seed {meeting.seed}"
        with nullcontext() if recording is None else recorded(env, recording, note):
            log = play_game(
                env, meeting.player, meeting.seed, meeting.seconds, lambda line: None, lambda fault: True,
                lambda loop, action, info: None,
            ).complete  # fmt: skip
    return Game(meeting.seed, log.score, log.seconds, len(log.faults))


def _file(folder: Path, meeting: Meeting) -> Path:
    return folder / f"game_{meeting.seed}.json"


def _read(folder: Path, meeting: Meeting) -> Game | None:
    path = _file(folder, meeting)
    if not path.exists():
        return None
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        same = content["format"] == FORMAT and Meeting(**content["meeting"]) == meeting
        game = Game(**content["game"] | {"goals": tuple(content["game"]["goals"])})
    except (ValueError, KeyError, TypeError):
        same = False
    if not same:
        raise ValueError(f"{path}: is no result of this game; name another folder, or remove it")
    return game
