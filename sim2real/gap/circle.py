"""The whole circle in stages, each of which keeps what it made in a folder and is not run again: play, diagnose,
fine-tune, play again.

```
DIR/conditions.json           who played, on what, with which seeds: the circle's conditions
DIR/simulator/games.json      the player in the simulator
DIR/before/                   games on the table, and recordings/ of the first of them
DIR/diagnosis/                of these recordings alone
DIR/ARM/training/             a run of `puckpilot train` for each arm that learns
DIR/ARM/games/                its player on the table, in games of the same seeds
DIR/gap.json, DIR/gap.html    the result
```
"""

from __future__ import annotations

import csv
import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from puckpilot_env.files.whole_file import write_text_whole
from sim2real.gap.arms import ARMS, DIAGNOSIS, Simulator, recordings_of, simulator_of, write_simulator
from sim2real.gap.page import page
from sim2real.table.twin.fidelity import Meeting, TwinGame, play_all
from sim2real.table.twin.score import change, score, shots

FORMAT = "puckpilot-gap/3"
VARIANT = "match-v0"
PRESET = "fine_tune"
Report = Callable[[str], None]


@dataclass(frozen=True)
class Conditions:
    """player, opponent: by name; table: a concealed one; games: of each player on the table, each of `seconds` of play
    at most, of which the first `recorded` are recorded; minutes: of fine-tuning; seed: of the first game and of
    learning."""

    player: str
    opponent: str
    table: str
    games: int
    seconds: float
    recorded: int
    minutes: float
    seed: int


class Circle:
    """A circle in its folder. processes: that play at once; report: takes a line for each stage that begins."""

    def __init__(self, folder: Path, conditions: Conditions, processes: int, report: Report) -> None:
        self.folder, self.conditions, self._processes, self._report = folder, conditions, processes, report
        _keep_conditions(folder, conditions)

    @property
    def diagnosis(self) -> Path:
        """Folder of the diagnosis."""
        return self.folder / DIAGNOSIS

    def run(self, arms: list[str], progress: Callable[[int, int], None]) -> dict[str, Any]:
        """All stages that are not done yet; the result, as it is written to gap.json."""
        simulated = self._simulated()
        self._report("playing on the table")
        before = self._games(self.conditions.player, self.folder / "before", progress, self.conditions.recorded)
        self._diagnose()
        players = {arm: self._tuned(arm) for arm in arms}
        after: dict[str, list[TwinGame]] = {}
        for arm, player in players.items():
            self._report(f"playing on the table: {ARMS[arm].words}")
            delay = ARMS[arm].camera_delay(self.folder, self.conditions.table)
            after[arm] = self._games(player, self.folder / arm / "games", progress, camera_delay=delay)
        result = self._result(simulated, before, after)
        write_text_whole(self.folder / "gap.json", json.dumps(result, indent=1) + "\n")
        write_text_whole(self.folder / "gap.html", page(result))
        return result

    def _simulated(self) -> dict[str, Any]:
        """The score in the simulator, with what is true of every table."""
        from puckpilot_env.variants import find_variant
        from sim2real.table.simulated import play_simulated

        path, c = self.folder / "simulator" / "games.json", self.conditions
        if not path.exists():
            self._report("playing in the simulator")
            match = play_simulated(VARIANT, c.player, c.opponent, 10 * c.games, c.seed)
            minutes = float(match.lengths.sum()) * find_variant(VARIANT).period / 60.0
            path.parent.mkdir(parents=True, exist_ok=True)
            content = {"goals": list(match.goals), "minutes": minutes}
            write_text_whole(path, json.dumps(content, indent=1) + "\n")
        return json.loads(path.read_text(encoding="utf-8"))

    def _games(
        self, player: str, folder: Path, progress: Callable[[int, int], None], recorded: int = 0,
        camera_delay: float = 0.0,
    ) -> list[TwinGame]:  # fmt: skip
        """A player's games on the table, of which the first are recorded, with a delay [s] that its loop allows for."""
        c = self.conditions
        meetings = [
            Meeting(
                player, c.opponent, VARIANT, c.seed + game, c.seconds, concealed=c.table, clears=True,
                recorded=game < recorded, camera_delay=camera_delay,
            )
            for game in range(c.games)
        ]  # fmt: skip
        folder.mkdir(parents=True, exist_ok=True)
        return play_all(meetings, folder, self._processes, progress)

    def _diagnose(self) -> None:
        if (self.diagnosis / "diagnosis.json").exists():
            return
        self._report("diagnosing what was recorded")
        _run("diagnose", *map(str, recordings_of(self.folder)), "--out", str(self.diagnosis))

    def _tuned(self, arm: str) -> str:
        """The name of an arm's player, fine-tuned as long as it should be. ValueError, in one line, if that fails."""
        c, folder = self.conditions, self.folder / arm
        run, done = folder / "training", folder / "trained"
        simulator = simulator_of(arm, self.folder, c.table)
        if simulator is None:
            return c.player
        if not done.exists():
            self._report(f"{ARMS[arm].words}, {c.minutes:g} minutes")
            given = ["--resume"] if (run / "checkpoint.pt").exists() else self._new_run(arm, simulator)
            left = max(c.minutes - _trained_minutes(run), 1e-3)
            _run("train", "--out", str(run), "--minutes", f"{left:g}", *given)
            write_text_whole(done, "")
        return f"policy:{run / 'policy.npz'}"

    def _new_run(self, arm: str, simulator: Simulator) -> list[str]:
        """The options of `puckpilot train` for an arm, whose simulator is written down."""
        c, folder = self.conditions, self.folder / arm
        folder.mkdir(parents=True, exist_ok=True)
        written = write_simulator(simulator, folder)
        files = [word for name, path in written.items() for word in (f"--{name}", str(path))]
        return [
            "--preset", PRESET, "--start", c.player, "--variant", VARIANT, "--seed", str(c.seed),
            "--threads", str(self._processes), *files,
        ]  # fmt: skip

    def _result(
        self, simulated: dict[str, Any], before: list[TwinGame], after: dict[str, list[TwinGame]]
    ) -> dict[str, Any]:
        content = json.loads((self.diagnosis / "diagnosis.json").read_text(encoding="utf-8"))
        return {
            "format": FORMAT,
            "conditions": asdict(self.conditions),
            "simulator": {
                name: goals / simulated["minutes"]
                for name, goals in zip(("scored", "conceded"), simulated["goals"], strict=True)
            },
            "before": _played(before),
            "found": [one["mechanism"] for one in content["findings"]],
            "verdict": content["verdict"],
            "arms": {arm: {**_played(games), "change": asdict(change(before, games))} for arm, games in after.items()},
        }


def _played(games: list[TwinGame]) -> dict[str, Any]:
    """What came of a player's games: rates a minute, shots, stops of the table, and each one's goals and seconds."""
    return {
        **{name: asdict(rate) for name, rate in score(games).items()},
        "shots": asdict(shots(games)),
        "stops": sum(game.stops for game in games),
        "games": [[*game.goals, game.seconds] for game in games],
    }


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


def _keep_conditions(folder: Path, conditions: Conditions) -> None:
    """Write down the conditions of a new circle. ValueError, in one line, for a folder of another one."""
    path = folder / "conditions.json"
    if path.exists():
        try:
            kept = Conditions(**json.loads(path.read_text(encoding="utf-8")))
        except (ValueError, TypeError):
            raise ValueError(f"{path} says nothing of a circle; name another --out") from None
        other = [one.name for one in fields(Conditions) if getattr(kept, one.name) != getattr(conditions, one.name)]
        if other:
            given = ", ".join(f"{name} {getattr(kept, name)}" for name in other)
            raise ValueError(f"{folder} has a circle with {given}; give the same, or name another --out")
        return
    folder.mkdir(parents=True, exist_ok=True)
    write_text_whole(path, json.dumps(asdict(conditions), indent=1) + "\n")
