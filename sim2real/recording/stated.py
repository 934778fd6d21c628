"""Merge the sizes that recordings of one table state, and note the sizes that none states."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.recording.folder import Recording, Stream
from sim2real.recording.table_parameters import FROM_META
from sim2real.recording.tuned import RECORDING


def together(recordings: Sequence[Recording], baseline: Mapping[str, float]) -> list[Recording]:
    """Give each recording all sizes that any of them states; sizes that none states come from `baseline`, if there.

    `baseline`: parameters of the simulator by name. Raises ValueError, in one line, if the recordings state sizes of
    different tables, pucks, mallets or gantries.
    """
    known = {name: baseline[name] for name in FROM_META if name in baseline}
    known |= {name: value for name in FROM_META if (value := _stated(recordings, name)) is not None}
    return [_stating(one, known) for one in recordings]


def assumptions(recordings: Sequence[Recording]) -> Iterator[str]:
    """A sentence for each size that a diagnosis needs and no recording states; `recordings` come from `together`."""
    for name, (section, key) in FROM_META.items():
        if recordings[0].nominal(section, key) is not None or not any(_needs(one, name) for one in recordings):
            continue
        if name == "goal_width":
            yield f"{section}.{key} is not stated: contacts with the end walls where a goal may be are ignored"
        else:
            row = BY_NAME[name]
            yield f"{section}.{key} is not stated: the simulator's default {row.default:g} {row.unit} is used"


def _stated(recordings: Sequence[Recording], name: str) -> float | None:
    """The value of the parameter `name` that the recordings agree on; None if none states it. See `together`."""
    section, key = FROM_META[name]
    values = [(one.name, value) for one in recordings if (value := one.nominal(section, key)) is not None]
    for who, value in values:
        first, known = values[0]
        if not np.isclose(known, value, rtol=RECORDING.measured_to if section == "gantry" else RECORDING.written_to):
            raise ValueError(
                f"{first} states {section}.{key} {known:g}, {who} {value:g}: "
                "these are different tables; diagnose each by itself"
            )
    return values[0][1] if values else None


def _stating(one: Recording, known: Mapping[str, float]) -> Recording:
    """A copy of the recording with the `known` sizes, by parameter name, in its meta data."""
    meta = {section: dict(one.meta.get(section) or {}) for section, _ in FROM_META.values()}
    for name, value in known.items():
        section, key = FROM_META[name]
        meta[section][key] = value
    return replace(one, meta={**one.meta, **meta})


def _needs(one: Recording, name: str) -> bool:
    """Whether the parameter `name` affects the analysis of the recorded streams."""
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
