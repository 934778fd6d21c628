"""A circle's folder: where each stage keeps what it makes, and the conditions under which it is made.

```
DIR/conditions.json               who played, on what, with which seeds: the circle's conditions
DIR/simulator/NAME.json           the player as it is ("before"), and that of each arm, in the simulator
DIR/before/                       games on the table, recordings/ of the first of them, and film.gif of the first
DIR/diagnosis/                    of these recordings alone, not of those of any arm
DIR/ARM/training/                 a run of `puckpilot train` for each arm that learns; or, of one that learns the same
                                  for every table, in the folder that circles of several tables share
DIR/ARM/games/, DIR/ARM/film.gif  its player on the table, in games of the same seeds
DIR/gap.json, DIR/gap.html        the result
```
"""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from puckpilot_env.files.whole_file import write_text_whole
from sim2real.gap.arms import ARMS, DIAGNOSIS, NO_DELAYS, Delays
from sim2real.gap.gap_table import PERSON, PHYSICAL, GapTable, find_gap_table
from sim2real.table.meetings import Meeting

VARIANT = "match-v0"
FILM = "film.gif"
KEPT = "conditions.json"
SHARED = "of_any_table"  # folder that circles of several tables share
BEFORE = "before"  # name of the player as it is
TRAINING = ("player", "minutes", "steps", "seed")  # conditions on which training rests


@dataclass(frozen=True)
class Conditions:
    """player, opponents: by name; backend, table: see `gap_table`; games: of each player on the table, against each
    opponent in turn, or a person, each of `seconds` of play, in matches, of which the first `recorded` are recorded;
    minutes or steps: of fine-tuning, the other is None; seed: of the first game and of learning; table_contents: a
    digest of a physical table's file, "" of the twin."""

    player: str
    opponents: tuple[str, ...]
    backend: str
    table: str
    games: int
    seconds: float
    recorded: int
    minutes: float | None
    steps: int | None
    seed: int
    table_contents: str = ""

    @property
    def physical(self) -> bool:
        """Whether the table is a physical one."""
        return self.backend == PHYSICAL

    @property
    def gap_table(self) -> GapTable:
        """Where it is played. ValueError, in one line, for an unknown table, or a file that is none."""
        return find_gap_table(self.backend, self.table)

    @property
    def opponents_at_table(self) -> tuple[str, ...]:
        """The opponents on the table, by name."""
        return (PERSON,) if self.physical else self.opponents


def training_words(minutes: float | None, steps: int | None) -> str:
    """How long each arm is fine-tuned, in words."""
    return f"{minutes:g} minutes" if steps is None else f"{1e-6 * steps:g} million steps"


@dataclass(frozen=True)
class CircleFolder:
    """The folder `path` of the circle of these conditions. shared: of arms that learn the same for every table, None
    for this one."""

    path: Path
    conditions: Conditions
    shared: Path | None = None

    def simulated(self, name: str) -> Path:
        """Goals and minutes in the simulator of the player as it is, BEFORE, or of an arm's."""
        return self.path / "simulator" / f"{name}.json"

    @property
    def before(self) -> Path:
        """Folder of the games of the player as it is."""
        return self.path / BEFORE

    @property
    def diagnosis(self) -> Path:
        """Folder of the diagnosis."""
        return self.path / DIAGNOSIS

    def diagnosed(self) -> dict[str, Any]:
        """What diagnosis.json says. ValueError, in one line, if there is none."""
        path = self.diagnosis / "diagnosis.json"
        if not path.exists():
            raise missing(self.diagnosis, "diagnosis", "diagnose")
        return json.loads(path.read_text(encoding="utf-8"))

    def trained(self, arm: str) -> Path:
        """The file that is there once an arm has learnt as long as it should."""
        return self._learnt(arm) / "trained"

    def _learnt(self, arm: str) -> Path:
        return (self.shared if self.shared and ARMS[arm].of_any_table else self.path) / arm

    def player(self, arm: str) -> str:
        """The name of an arm's player. ValueError, in one line, if it has not learnt yet."""
        if ARMS[arm].simulator is None:
            return self.conditions.player
        if not self.trained(arm).exists():
            raise missing(self._learnt(arm), "trained player", "tune")
        return f"policy:{self._learnt(arm) / 'training' / 'policy.npz'}"

    def meetings_before(self) -> list[Meeting]:
        """The games on the table of the player as it is."""
        return self._meetings(self.conditions.player)

    def meetings_after(self, arm: str) -> list[Meeting]:
        """Those of an arm's player. ValueError, in one line, if it has not learnt yet."""
        return self._meetings(self.player(arm), ARMS[arm].delays(self.path, self.conditions.gap_table))

    def _meetings(self, player: str, delays: Delays = NO_DELAYS) -> list[Meeting]:
        """A player's games, with the delays that its loop allows for. The first are recorded, of every player: what
        records takes time at a face-off, so that games of a seed would else differ in more than the player."""
        c = self.conditions
        return [
            Meeting(
                player,
                c.opponents_at_table[game % len(c.opponents_at_table)],
                VARIANT,
                c.seed + game,
                c.seconds,
                again=True,
                concealed="" if c.physical else c.table,
                clears=not c.physical,
                recorded=game < c.recorded,
                camera_delay=delays.camera,
                command_delay=delays.command,
                table=c.table if c.physical else "",
            )
            for game in range(c.games)
        ]


def missing(folder: Path, what: str, stage: str) -> ValueError:
    """The error, in one line, of a stage that needs what an earlier one would have left in a folder."""
    return ValueError(f"{folder} has no {what} yet; run the stage '{stage}' first")


def refuse_other(folder: Path, conditions: Conditions) -> None:
    """ValueError, in one line, for a folder of another circle."""
    _refuse_other(folder, _of_circle(conditions), "a circle")


def keep_conditions(folder: Path, conditions: Conditions) -> None:
    """Write down the conditions of a new circle. ValueError, in one line, for a folder of another one."""
    _keep(folder, _of_circle(conditions), "a circle")


def refuse_other_training(folder: Path, conditions: Conditions) -> None:
    """ValueError, in one line, for a folder, that circles of several tables share, of arms trained otherwise."""
    _refuse_other(folder, _of_training(conditions), "players")


def keep_training(folder: Path, conditions: Conditions) -> None:
    """Write down, in a new folder that circles of several tables share, what the training of its arms rests on.
    ValueError, in one line, as of `refuse_other_training`."""
    _keep(folder, _of_training(conditions), "players")


def _of_circle(conditions: Conditions) -> dict[str, Any]:
    return {one.name: getattr(conditions, one.name) for one in fields(Conditions)}


def _of_training(conditions: Conditions) -> dict[str, Any]:
    return {name: getattr(conditions, name) for name in TRAINING}


def _keep(folder: Path, conditions: dict[str, Any], of_what: str) -> None:
    if not _refuse_other(folder, conditions, of_what):
        folder.mkdir(parents=True, exist_ok=True)
        write_text_whole(folder / KEPT, json.dumps(conditions, indent=1) + "\n")


def _refuse_other(folder: Path, conditions: dict[str, Any], of_what: str) -> bool:
    """Whether the folder has conditions. ValueError, in one line, if they are others."""
    path = folder / KEPT
    if not path.exists():
        return False
    try:
        kept = json.loads(path.read_text(encoding="utf-8"))
    except ValueError:
        kept = None
    if not isinstance(kept, dict) or kept.keys() != conditions.keys():
        raise ValueError(f"{path} is not of this version; name another --out")
    kept = {name: tuple(one) if isinstance(one, list) else one for name, one in kept.items()}
    if other := [name for name in conditions if kept[name] != conditions[name]]:
        given = " ".join(filter(None, (_as_option(name, kept[name]) for name in other)))
        raise ValueError(f"{folder} has {of_what} with {given}; give the same, or name another --out")
    return True


def _as_option(name: str, value: Any) -> str:
    """A condition as the option that gives it; "" for one that was not given."""
    if name == "player" or value is None:
        return value or ""
    if name == "opponents":
        return " ".join(f"--opponent {one}" for one in value)
    if name == "table_contents":
        return "other contents of the table's file"
    return f"--{name} {value:g}" if isinstance(value, float) else f"--{name} {value}"
