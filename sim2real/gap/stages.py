"""The stages of a circle, by name in the order in which they are run. Each does what is not done yet, on what those
before it left; ValueError, in one line, says what they did not."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from puckpilot_env.files.whole_file import write_text_whole
from sim2real.gap.arms import ARMS, Simulator, recordings_of
from sim2real.gap.circle_folder import BEFORE, FILM, VARIANT, CircleFolder, missing, training_words
from sim2real.gap.film import film
from sim2real.gap.gap_table import GapTable
from sim2real.gap.in_simulator import TRUTH, UNCHANGED, simulate
from sim2real.gap.report.page import page
from sim2real.gap.result import result
from sim2real.gap.tuning import fine_tune, untrained
from sim2real.table.meetings import Meeting, kept_games, play_all

Progress = Callable[[int, int], None]
Report = Callable[[str], None]


@dataclass(frozen=True)
class Work:
    """What a stage works on: a circle's folder, for these arms. processes: that play or learn at once; report: takes a
    line for each thing that begins; progress: games done, and of how many."""

    folder: CircleFolder
    arms: list[str]
    processes: int
    report: Report
    progress: Progress


def play(work: Work) -> None:
    """The player as it is: games in the simulator, and on the table, where the first of them are recorded."""
    work.report("playing in the simulator, and on the table")
    _simulate(work, BEFORE, work.folder.conditions.player)
    _games(work, work.folder.meetings_before(), work.folder.before, BEFORE)


def _simulate(work: Work, name: str, player: str) -> None:
    """The score in the simulator, with what is true of every table: without and, where it is known and the simulator
    has it, with what is concealed."""
    c = work.folder.conditions
    simulate(
        work.folder.simulated(name), VARIANT, player, c.opponents, 10 * c.games, c.seed, simulated_tables(c.gap_table)
    )


def simulated_tables(table: GapTable) -> dict[str, Mapping[str, float]]:
    """Parameters of the simulator's tables, UNCHANGED and of the TRUTH. Of a camera that is late, and of commands that
    are, it has nothing: a table that conceals nothing else has no TRUTH there."""
    unchanged = Simulator().at_table(table.parameters).values
    if table.concealed is None:
        return {UNCHANGED: unchanged}
    truth = Simulator(table.concealed.truth).at_table(table.parameters).values
    shows = truth != unchanged or not table.concealed.truth
    return {UNCHANGED: unchanged, **({TRUTH: truth} if shows else {})}


def _games(work: Work, meetings: list[Meeting], folder: Path, name: str) -> None:
    """Play games, whose results go into a folder, and film the first, on a twin, as that of "before" or of an arm."""
    filmed = work.folder.path / name / FILM
    folder.mkdir(parents=True, exist_ok=True)
    play_all(meetings, folder, work.processes, work.progress)
    if not filmed.exists() and not work.folder.conditions.physical:
        film(meetings[0], filmed, work.folder.conditions.player if name == BEFORE else name)


def diagnose(work: Work) -> None:
    """The diagnosis of what was recorded."""
    folder = work.folder.diagnosis
    if (folder / "diagnosis.json").exists():
        return
    meetings = work.folder.meetings_before()[: work.folder.conditions.recorded]
    recordings = recordings_of(work.folder.path)
    if len(kept_games(meetings, work.folder.before)) < len(meetings) or len(recordings) < len(meetings):
        raise missing(work.folder.before, f"recordings of {len(meetings)} games that were over", "play")
    work.report("diagnosing what was recorded")
    _run("diagnose", *map(str, recordings), "--out", str(folder))


def tune(work: Work) -> None:
    """The player of each arm that learns, fine-tuned as long as it should be."""
    work.folder.diagnosed()
    arms = untrained(work.folder, work.arms)
    if arms:
        c = work.folder.conditions
        work.report(f"{training_words(c.minutes, c.steps)} of training each: {', '.join(arms)}")
        fine_tune(work.folder, arms, work.processes)


def replay(work: Work) -> None:
    """The games of each arm's player on the table."""
    work.folder.diagnosed()
    players = {arm: work.folder.meetings_after(arm) for arm in work.arms}
    for arm, meetings in players.items():
        if not work.folder.conditions.physical:
            work.report(f"playing on the table: {ARMS[arm].words}")
        _simulate(work, arm, meetings[0].player)
        if not work.folder.conditions.physical:
            _games(work, meetings, work.folder.path / arm / "games", arm)
    if work.folder.conditions.physical:
        _in_mixed_order(work, players)


def _in_mixed_order(work: Work, players: Mapping[str, list[Meeting]]) -> None:
    """The games of all arms against a person, who does not know which arm plays: each plays once before any plays
    again, in an order drawn from the circle's seed."""
    rng, c = np.random.default_rng(work.folder.conditions.seed), work.folder.conditions
    order = [(arm, game) for game in range(c.games) for arm in rng.permutation(list(players)).tolist()]
    for number, (arm, game) in enumerate(order, 1):
        work.report(f"playing on the table: game {number} of {len(order)}")
        _games(work, [players[arm][game]], work.folder.path / arm / "games", arm)


def report(work: Work) -> None:
    """The result, as gap.json and gap.html."""
    content = result(work.folder, work.arms)
    write_text_whole(work.folder.path / "gap.json", json.dumps(content, indent=1) + "\n")
    write_text_whole(work.folder.path / "gap.html", page(content, work.folder.conditions.gap_table))


STAGES: Mapping[str, Callable[[Work], None]] = {one.__name__: one for one in (play, diagnose, tune, replay, report)}
FIRST, LAST = play.__name__, report.__name__


def _run(*words: str) -> None:
    """Run a command of puckpilot, which prints to stderr here. ValueError, in one line, if it fails."""
    if subprocess.run([sys.executable, "-m", "puckpilot", *words], stdout=sys.stderr, check=False).returncode:
        raise ValueError(f"puckpilot {' '.join(words)} failed, as it says above")
