"""Unlisted laws: their changes of the law, their regimes, and the quantities that they depend on.

A diagnosis should report them as unlisted, with regime and dependence.
"""

from __future__ import annotations

from math import cos, pi, sin

from sim2real.study.independent_table.mechanisms import GANTRY, PUCK, ROBOT, Change, Mechanism, Rng
from sim2real.study.independent_table.physics.law import Law


def _vortex(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    size = 0.06 * share * (1.0 if rng.uniform() < 0.5 else -1.0)
    x, y = rng.uniform(0.3, 0.7) * law.length, rng.uniform(0.35, 0.65) * law.width
    return Change(law={"vortex": size, "vortex_x": x, "vortex_y": y, "vortex_size": rng.uniform(0.2, 0.35)})


def _washboard(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"washboard": 0.12 * share, "washboard_length": rng.uniform(0.3, 0.7)})


def _stripe(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    at, width = rng.uniform(0.3, 0.7) * law.length, rng.uniform(0.15, 0.35)
    return Change(law={"stripe": 0.15 * share, "stripe_x": at, "stripe_width": width})


def _tilt_drift(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    heading, rate = rng.uniform(-pi, pi), 0.002 * share
    changes = {"tilt_drift_x": rate * cos(heading), "tilt_drift_y": rate * sin(heading), "tilt_drift_from": 25.0}
    return Change(law=changes)


def _breathing(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"breathing": min(0.9, 0.4 * share), "breathing_period": rng.uniform(4.0, 20.0)})


def _push(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    heading, size, begin = rng.uniform(-pi, pi), 0.06 * share, rng.uniform(8.0, 35.0)
    changes = {"push_x": size * cos(heading), "push_y": size * sin(heading), "push_from": begin}
    return Change(law={**changes, "push_until": begin + rng.uniform(12.0, 25.0)})


def _pulse(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"pulse": 0.4 * share, "pulse_period": rng.uniform(4.0, 12.0)})


def _cubic(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"cubic_drag": 0.08 * share, "drag": 0.02})


def _slow(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"slow_friction": 0.12 * share, "slow_speed": rng.uniform(0.2, 0.5)})


def _grain(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"grain": min(0.9, 0.35 * share)})


def _nap(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"nap": min(0.9, 0.35 * share), "nap_heading": rng.uniform(-pi, pi)})


def _fading(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"fading": 0.25 * share, "fading_time": rng.uniform(0.2, 0.6)})


def _wall_wave(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"wall_wave": 0.08 * share, "wall_wave_length": rng.uniform(0.4, 0.9)})


def _wall_warming(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"wall_warming": -0.003 * share, "wall_restitution": 0.85})


def _soft_stretch(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    begin, part = rng.uniform(0.1, 0.5), rng.uniform(0.35, 0.5)
    changes = {"stretch_wall": int(rng.integers(2, 4)), "stretch_extra": -0.12 * share, "wall_restitution": 0.75}
    return Change(law={**changes, "stretch_from": begin * law.length, "stretch_until": (begin + part) * law.length})


def _mallet_warming(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"mallet_warming": -0.004 * share, "mallet_restitution": 0.85})


def _rough(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"rough": min(0.9, 0.2 * share), "rough_length": rng.uniform(0.25, 0.6)})


def _cubic_loss(rng: Rng, share: float, law: Law, scenario: str) -> Change:
    return Change(law={"cubic_loss": 0.1 * share})


# name: the law and the quantities that it depends on
LAWS: dict[str, tuple[Mechanism, tuple[str, ...]]] = {
    "vortex": (Mechanism("glide", PUCK, _vortex), ("position",)),
    "washboard": (Mechanism("glide", PUCK, _washboard), ("position",)),
    "stripe": (Mechanism("glide", PUCK, _stripe), ("position",)),
    "tilt_drift": (Mechanism("glide", PUCK, _tilt_drift), ("time",)),
    "push": (Mechanism("glide", PUCK, _push), ("time",)),
    "pulse": (Mechanism("glide", PUCK, _pulse), ("time",)),
    "breathing": (Mechanism("glide", PUCK, _breathing), ("time",)),
    "cubic_drag": (Mechanism("glide", PUCK, _cubic), ("speed",)),
    "slow_friction": (Mechanism("glide", PUCK, _slow), ("speed",)),
    "grain": (Mechanism("glide", PUCK, _grain), ("heading",)),
    "nap": (Mechanism("glide", PUCK, _nap), ("heading",)),
    "fading": (Mechanism("glide", PUCK, _fading), ("history",)),
    "wall_wave": (Mechanism("wall", PUCK, _wall_wave), ("position",)),
    "wall_warming": (Mechanism("wall", PUCK, _wall_warming), ("time",)),
    "soft_stretch": (Mechanism("wall", PUCK, _soft_stretch), ("position",)),
    "mallet_warming": (Mechanism("mallet", ROBOT, _mallet_warming), ("time",)),
    "rough": (Mechanism("gantry", GANTRY, _rough), ("position",)),
    "cubic_loss": (Mechanism("gantry", GANTRY, _cubic_loss), ("speed",)),
}
