"""The stages of a circle, by name in the order in which they are run. Each does what is not done yet, on what those
before it left; ValueError, in one line, says what they did not."""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

from puckpilot_env.files.whole_file import write_text_whole
from sim2real.gap.arms import ARMS, recordings_of, simulator_of, write_simulator
from sim2real.gap.circle_folder import FILM, VARIANT, CircleFolder, missing
from sim2real.gap.film import film
from sim2real.gap.page import page
from sim2real.gap.result import result
from sim2real.table.twin.fidelity import Meeting, play_all

PRESET = "fine_tune"
Progress = Callable[[int, int], None]
Report = Callable[[str], None]


@dataclass(frozen=True)
class Work:
    """What a stage works on: a circle's folder, for these arms. processes: that play at once; report: takes a line for
    each thing that begins; progress: games done, and of how many."""

    folder: CircleFolder
    arms: list[str]
    processes: int
    report: Report
    progress: Progress


def play(work: Work) -> None:
    """The player as it is: games in the simulator, and on the table, where the first of them are recorded."""
    _simulate(work)
    work.report("playing on the table")
    _games(work, work.folder.meetings_before(), work.folder.before, "before")


def _simulate(work: Work) -> None:
    """The score in the simulator, with what is true of every table."""
    from puckpilot_env.variants import find_variant
    from sim2real.table.simulated import play_simulated

    path, c = work.folder.simulated, work.folder.conditions
    if path.exists():
        return
    work.report("playing in the simulator")
    match = play_simulated(VARIANT, c.player, c.opponent, 10 * c.games, c.seed)
    minutes = float(match.lengths.sum()) * find_variant(VARIANT).period / 60.0
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text_whole(path, json.dumps({"goals": list(match.goals), "minutes": minutes}, indent=1) + "\n")


def _games(work: Work, meetings: list[Meeting], folder: Path, name: str) -> None:
    """Play games, whose results go into a folder, and film the first as that of "before" or of an arm."""
    filmed = work.folder.path / name / FILM
    folder.mkdir(parents=True, exist_ok=True)
    play_all(meetings, folder, work.processes, work.progress)
    if not filmed.exists():
        film(meetings[0], filmed, work.folder.conditions.player if name == "before" else name)


def diagnose(work: Work) -> None:
    """The diagnosis of what was recorded."""
    folder = work.folder.diagnosis
    if (folder / "diagnosis.json").exists():
        return
    c = work.folder.conditions
    recordings = recordings_of(work.folder.path)
    if len(recordings) < c.recorded:
        raise missing(work.folder.before, f"recordings of {c.recorded} games", "play")
    work.report("diagnosing what was recorded")
    _run("diagnose", *map(str, recordings), "--out", str(folder))


def tune(work: Work) -> None:
    """The player of each arm that learns, fine-tuned as long as it should be."""
    work.folder.diagnosed()
    for arm in work.arms:
        _tune(work, arm)


def _tune(work: Work, arm: str) -> None:
    c, done = work.folder.conditions, work.folder.trained(arm)
    simulator = simulator_of(arm, work.folder.path, c.table)
    if simulator is None or done.exists():
        return
    work.report(f"{ARMS[arm].words}, {c.minutes:g} minutes")
    run = done.parent / "training"
    given = ["--resume"]
    if not (run / "checkpoint.pt").exists():
        done.parent.mkdir(parents=True, exist_ok=True)
        written = write_simulator(simulator, done.parent)
        files = [word for name, path in written.items() for word in (f"--{name}", str(path))]
        given = [
            "--preset", PRESET, "--start", c.player, "--variant", VARIANT, "--seed", str(c.seed),
            "--threads", str(work.processes), *files,
        ]  # fmt: skip
    left = max(c.minutes - _trained_minutes(run), 1e-3)
    _run("train", "--out", str(run), "--minutes", f"{left:g}", *given)
    write_text_whole(done, "")


def replay(work: Work) -> None:
    """The games of each arm's player on the table."""
    work.folder.diagnosed()
    players = {arm: work.folder.meetings_after(arm) for arm in work.arms}
    for arm, meetings in players.items():
        work.report(f"playing on the table: {ARMS[arm].words}")
        _games(work, meetings, work.folder.path / arm / "games", arm)


def report(work: Work) -> None:
    """The result, as gap.json and gap.html."""
    content = result(work.folder, work.arms)
    write_text_whole(work.folder.path / "gap.json", json.dumps(content, indent=1) + "\n")
    write_text_whole(work.folder.path / "gap.html", page(content))


STAGES: Mapping[str, Callable[[Work], None]] = {one.__name__: one for one in (play, diagnose, tune, replay, report)}
LAST = report.__name__


def _run(*words: str) -> None:
    """Run a command of puckpilot, which prints to stderr here. ValueError, in one line, if it fails."""
    if subprocess.run([sys.executable, "-m", "puckpilot", *words], stdout=sys.stderr, check=False).returncode:
        raise ValueError(f"puckpilot {' '.join(words)} failed, as it says above")


def _trained_minutes(run: Path) -> float:
    """How long a run has been trained, by its curve."""
    curve = run / "curve.csv"
    if not curve.exists():
        return 0.0
    with curve.open(encoding="utf-8", newline="") as file:
        return max((float(row["seconds"]) for row in csv.DictReader(file)), default=0.0) / 60.0
