"""What a player is fine-tuned on, from the diagnosis, from the recordings alone or from neither: an arm each.

Every arm that learns knows what is true of every table, AT_TABLE: it is no secret of this one.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from puckpilot_env.files.toml_file import refuse_unknown
from puckpilot_env.files.whole_file import write_text_whole
from puckpilot_env.options import effects_file
from puckpilot_env.options.at_table import AT_TABLE
from puckpilot_env.options.draws_file import read_draws
from puckpilot_env.options.effects_file import effect_values
from puckpilot_env.physics.effects import EFFECTS
from puckpilot_env.variants import find_variant
from sim2real.gap.gap_table import GapTable
from sim2real.gap.residual_fit import write_residual
from sim2real.table.board_config import MOST_COMMAND_DELAY
from sim2real.table.twin.concealed import ConcealedTable

CEILING, OWN = "truth", "corrected"  # names of arms
DIAGNOSIS = "diagnosis"  # its folder in the circle's
# Of late commands a loop that allows for them leaves nothing. In the simulator nothing allows for them: who learns with
# them there learns to live with far more.
HELD = EFFECTS["command_delay"].row_names
SENSORS = ("camera_", "beam_", "frame_", "dropped_", "held_")  # without effect where players see the state


@dataclass(frozen=True)
class Simulator:
    """A simulator to learn on: parameters of all tables by name; draws, see `draws_file`; and recordings to whose
    residuals a network is fitted that corrects its steps, none for no network."""

    values: Mapping[str, float] = field(default_factory=dict)
    draws: Mapping[str, Any] | None = None
    residual_of: tuple[Path, ...] = ()

    def at_table(self, known: Mapping[str, float]) -> Simulator:
        """The same with what is `known` of this table, where nothing else was found, and with what is true of every
        table; and without what HELD is said of."""
        values = {name: value for name, value in {**known, **self.values}.items() if name not in HELD}
        if self.draws is None:
            return replace(self, values={**values, **AT_TABLE})
        draws = read_draws(self.draws).as_dict()
        for part in ("parameters", "draws"):
            for name in HELD:
                draws[part].pop(name, None)
        return replace(self, values={**values, **AT_TABLE}, draws=draws)


@dataclass(frozen=True)
class Delays:
    """What a loop allows for [s]: how late stamps of frames are; how late motors obey, None for what the table's file
    states."""

    camera: float = 0.0
    command: float | None = None


NO_DELAYS = Delays()


@dataclass(frozen=True)
class Arm:
    """words: what it does; simulator: what is learnt on, None if nothing is learnt; delays: that the loop allows for.
    Both are made from the circle's folder, with before/recordings and diagnosis, and its table.
    of_any_table: whether it learns the same whatever the table; needs_truth: whether it takes one that is known."""

    words: str
    simulator: Callable[[Path, GapTable], Simulator] | None
    delays: Callable[[Path, GapTable], Delays] = lambda circle, table: NO_DELAYS
    of_any_table: bool = False
    needs_truth: bool = False


def recordings_of(circle: Path) -> tuple[Path, ...]:
    """The recordings of a circle, in order of their names; none where none are."""
    return tuple(sorted((circle / "before" / "recordings").glob("game_*")))


def _corrected(circle: Path, table: GapTable) -> Simulator:
    """All that was found, and the intervals of what was measured."""
    drawn = read_draws(circle / DIAGNOSIS / "draws.toml").as_dict()
    return Simulator(effect_values(circle / DIAGNOSIS / "effects.toml"), drawn if drawn["draws"] else None)


def _found_delays(circle: Path, table: GapTable) -> Delays:
    """By how much a diagnosis found stamps later than exposures, and motors than orders, as far as a board can allow
    for it."""
    content = json.loads((circle / DIAGNOSIS / "diagnosis.json").read_text(encoding="utf-8"))
    late = {one["mechanism"]: one["parameters"] for one in content["findings"]}
    camera, command = (
        float(late[name]["delay_s"]["value"]) if name in late else None for name in ("camera_delay", "command_delay")
    )
    return Delays(camera or 0.0, None if command is None else min(command, MOST_COMMAND_DELAY))


def _true_delays(circle: Path, table: GapTable) -> Delays:
    concealed = _concealed(table)
    return Delays(concealed.errors.stamp_late, concealed.truth.get("command_delay"))


def _constants(circle: Path, table: GapTable) -> Simulator:
    """The baseline's parameters as they were refitted, beside what was named, and nothing of that."""
    content = json.loads((circle / DIAGNOSIS / "diagnosis.json").read_text(encoding="utf-8"))
    return Simulator({name: float(one["value"]) for name, one in content["baseline"]["parameters"].items()})


def _residual(circle: Path, table: GapTable) -> Simulator:
    """The unchanged simulator under a network of its residuals on what was recorded."""
    if not (recordings := recordings_of(circle)):
        raise ValueError(f"{circle / 'before'} has no recordings, to which a network could be fitted")
    return Simulator(residual_of=recordings)


def _randomized(circle: Path, table: GapTable) -> Simulator:
    """The ranges of `match-randomized-v0`, whatever was recorded, but of what is known of the table."""
    rows = {
        draw.parameter: {"low": draw.low, "high": draw.high}
        for draw in find_variant("match-randomized-v0").draws
        if not draw.parameter.startswith(SENSORS) and draw.parameter not in table.parameters
    }
    return Simulator({}, rows)


def _concealed(table: GapTable) -> ConcealedTable:
    if table.concealed is None:
        raise ValueError(f"{table.words}: its truth is not known; leave the arm {CEILING} out")
    return table.concealed


ARMS = {
    "allowing": Arm("as it is; the loop allows for the delays of camera and commands", None, _found_delays),
    "unchanged": Arm("fine-tuned on the unchanged simulator", lambda circle, table: Simulator(), of_any_table=True),
    "randomized": Arm("fine-tuned on randomized tables", _randomized, of_any_table=True),
    "constants": Arm("fine-tuned with refitted constants alone, without what was named", _constants),
    "residual": Arm("fine-tuned on the simulator with a black-box network of its residuals",
                    _residual),
    "corrected": Arm("fine-tuned with what the diagnosis found", _corrected, _found_delays),
    "truth": Arm("fine-tuned on the concealed truth: the ceiling",
                 lambda circle, table: Simulator(_concealed(table).truth),
                 _true_delays, needs_truth=True),
}  # fmt: skip


def write_simulator(simulator: Simulator, folder: Path) -> dict[str, Path]:
    """Write a simulator as the files that `puckpilot train` takes; their paths by its options: effects, draws,
    residual. ValueError, in one line, where no network can be fitted."""
    lines = [f'format = "{effects_file.FORMAT}"', "[parameters]"]
    lines += [f"{name} = {float(value)!r}" for name, value in simulator.values.items()]
    files = {"effects": "\n".join(lines) + "\n"}
    if simulator.draws is not None:
        content = read_draws(simulator.draws).as_dict()
        lines = [f'format = "{content["format"]}"', "[parameters]"]
        lines += [f"{name} = {float(value)!r}" for name, value in content["parameters"].items()]
        for name, row in content["draws"].items():
            lines += [f"[draws.{name}]", *(f"{key} = {json.dumps(value)}" for key, value in row.items())]
        files["draws"] = "\n".join(lines) + "\n"
    for name, text in files.items():
        write_text_whole(folder / f"{name}.toml", text)
    paths = {name: folder / f"{name}.toml" for name in files}
    if simulator.residual_of:
        paths["residual"] = write_residual(simulator.residual_of, simulator.values, folder / "residual.npz")
    return paths


def simulator_of(arm: str, circle: Path, table: GapTable) -> Simulator | None:
    """What an arm learns on, by the circle's folder; None if it learns nothing. ValueError, in one line, for an unknown
    arm, and for one that needs a truth where none is known."""
    refuse_unknown([arm], ARMS, "arm")
    simulator = ARMS[arm].simulator
    return simulator(circle, table).at_table(table.parameters) if simulator else None
