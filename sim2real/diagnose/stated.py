"""What recordings of one table state of it, taken together: each size once, and those that nobody states."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.nominal import FROM_META
from sim2real.recording import Recording, Stream

WRITTEN_TO, MEASURED_TO = 1e-6, 0.01  # share by which a size may differ, and what is measured anew for each recording


def together(recordings: Sequence[Recording], baseline: Mapping[str, float]) -> list[Recording]:
    """The recordings, each with every size that one of them states or, where none does, `baseline` does by its name.

    ValueError, in one line, if they state sizes of different tables, pucks, mallets or gantries.
    """
    known = {name: baseline[name] for name in FROM_META if name in baseline}
    known |= {name: value for name in FROM_META if (value := _stated(recordings, name)) is not None}
    return [_stating(one, known) for one in recordings]


def assumptions(recordings: Sequence[Recording]) -> Iterator[str]:
    """A sentence for each number that the diagnosis needs and no recording states; of what `together` gives."""
    for name, (section, key) in FROM_META.items():
        if recordings[0].nominal(section, key) is not None or not any(_needs(one, name) for one in recordings):
            continue
        if name == "goal_width":
            yield f"{section}.{key} is not stated: what touched the end walls where goals may be is left out"
        else:
            row = BY_NAME[name]
            yield f"{section}.{key} is not stated: taken for the simulator's own {row.default:g} {row.unit}"


def _stated(recordings: Sequence[Recording], name: str) -> float | None:
    """What all recordings that state a number say; None where none does."""
    section, key = FROM_META[name]
    values = [(one.name, value) for one in recordings if (value := one.nominal(section, key)) is not None]
    for who, value in values:
        first, known = values[0]
        if not np.isclose(known, value, rtol=MEASURED_TO if section == "gantry" else WRITTEN_TO):
            raise ValueError(
                f"{first} states {section}.{key} {known:g}, {who} {value:g}: "
                "these are different tables; diagnose each by itself"
            )
    return values[0][1] if values else None


def _stating(one: Recording, known: Mapping[str, float]) -> Recording:
    meta = {section: dict(one.meta.get(section) or {}) for section, _ in FROM_META.values()}
    for name, value in known.items():
        section, key = FROM_META[name]
        meta[section][key] = value
    return replace(one, meta={**one.meta, **meta})


def _needs(one: Recording, name: str) -> bool:
    """Whether a number bears on what was recorded."""
    puck, opponent, robot = (
        _seen(stream, column)
        for stream, column in ((one.frames, "puck_x"), (one.frames, "opponent_x"), (one.mallet, "mallet_x"))
    )
    plans, log = (stream is not None and stream.rows > 0 for stream in (one.commands, one.drive))
    if name == "mallet_radius":
        return puck and (robot or opponent)
    if name == "max_voltage":
        return robot and log and not plans
    if name == "pulley_radius":
        return robot and (log or plans)
    return puck


def _seen(stream: Stream | None, column: str) -> bool:
    return stream is not None and bool(np.isfinite(stream[column]).any())
