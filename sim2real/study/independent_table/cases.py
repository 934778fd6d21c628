"""Cases for a diagnosis: a randomly drawn table, with or without missing effects, and its key.

A case depends only on the seed and its number, so a larger set of cases of one seed begins with the same ones.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from sim2real.study.independent_table.mechanisms import INCOMPATIBLE, MECHANISMS, Mechanism, Rng
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.physics.unlisted import LAWS
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.scene import Hand

# kind: number of cases in every BLOCK
KINDS = {"nothing": 5, "parameters": 3, "one": 7, "two": 2, "unlisted": 3}
BLOCK = sum(KINDS.values())
PLAIN_SCENARIOS = {"launches": 0.4, "posts": 0.1, "rally": 0.15, "match": 0.05, "gantry": 0.2, "drive": 0.1}
# scenario: its probability for cases with two mechanisms
PAIRS = {"launches": 0.5, "posts": 0.1, "rally": 0.2, "gantry": 0.2}
LIFTED = {"rally": ("glide", "wall"), "posts": ("glide", "wall")}  # regimes that such a recording shows as well
WEAKEST, STRONGEST = 0.5, 2.0
FILM = Camera(noise=2e-5, jitter=0.0, dropped=0.005, correlation_time=0.0125, place_error=1.8e-4, beam=0.05)
# A further kind, which no block contains: nothing is missing, but the sensor or the puck is at its worst, in turn
DISTURBED = "disturbed"
DISTURBANCES = ("map error", "autocorrelated noise", "spinning puck")
MAP_ERROR = 8e-4  # m, stated standard deviation of the calibration's error
FRAME_CORRELATION = 0.6  # of the noise in consecutive frames (AR(1))
SPIN = 12.0  # rad/s, standard deviation at launch


@dataclass(frozen=True)
class Case:
    """What to simulate, and `truth`, the key."""

    scenario: str
    law: Law
    camera: Camera
    hand: Hand
    encoder_noise: float
    truth: dict[str, Any] = field(default_factory=dict)


def draw_case(seed: int, number: int, kind: str | None = None, name: str | None = None, filmed: bool = False) -> Case:
    """Draw case `number` of a seed.

    `kind` and `name` (a mechanism or an unlisted law) restrict the draw; `filmed`: the camera is a calibrated one.
    Raises ValueError for an unknown kind or name.
    """
    if kind == DISTURBED:
        return _disturbed_case(np.random.default_rng([seed, number, 1]), DISTURBANCES[number % len(DISTURBANCES)])
    if kind is not None and kind not in KINDS:
        raise ValueError(f"unknown kind {kind!r}: expected one of {', '.join([*KINDS, DISTURBED])}")
    if name is not None and name not in {**MECHANISMS, **LAWS}:
        raise ValueError(f"unknown mechanism {name!r}: expected one of {', '.join([*MECHANISMS, *LAWS])}")
    if name is not None:
        kind, turn = "one" if name in MECHANISMS else "unlisted", number
    elif kind is not None:
        turn = number
    else:
        kind, turn = kind_of(seed, number)
    rng = np.random.default_rng([seed, number, 1])
    if kind == "two":
        scenario, names = _pair(rng)
    elif kind in ("one", "unlisted"):
        names = [name or _dealt(list(MECHANISMS if kind == "one" else LAWS), seed, turn)]
        scenario = str(rng.choice(_mechanism(names[0]).scenarios))
    else:
        scenario, names = _choice(rng, PLAIN_SCENARIOS), []
    law = _table(rng)
    if kind == "parameters" or (names and rng.uniform() < 0.5):
        law = _other_parameters(rng, law)
    calibrated = replace(FILM, calibration=int(rng.integers(2**31))) if filmed else None
    return _with(rng, kind, scenario, law, names, calibrated)


def _disturbed_case(rng: Rng, disturbance: str) -> Case:
    """A table without a missing effect, with a disturbance that a diagnosis could take for one."""
    seen = {name: weight for name, weight in PLAIN_SCENARIOS.items() if name not in ("gantry", "drive")}
    scenario = _choice(rng, {name: weight / sum(seen.values()) for name, weight in seen.items()})
    law, camera, spin = _table(rng), _camera(rng), 0.0
    if disturbance == "map error":
        camera = replace(FILM, place_error=MAP_ERROR, calibration=int(rng.integers(2**31)))
    elif disturbance == "autocorrelated noise":
        camera = replace(camera, correlation_time=-1.0 / (camera.rate * np.log(FRAME_CORRELATION)), correlated=1.0)
    else:
        spin = SPIN
    case = _with(rng, "nothing", scenario, law, [], camera)
    return replace(case, hand=replace(case.hand, spin=spin), truth={**case.truth, "disturbance": disturbance})


def kind_of(seed: int, number: int) -> tuple[str, int]:
    """The kind of a case, and the number of earlier cases of that kind."""
    kinds = [kind for kind, count in KINDS.items() for _ in range(count)]
    block, place = divmod(number, BLOCK)
    order = np.random.default_rng([seed, block, 2]).permutation(BLOCK)
    kind = kinds[order[place]]
    return kind, block * KINDS[kind] + sum(kinds[k] == kind for k in order[:place])


def _dealt(names: list[str], seed: int, turn: int) -> str:
    """Deal the names in rounds: each name once per round, in a random order."""
    turned, place = divmod(turn, len(names))
    return names[np.random.default_rng([seed, turned, len(names), 3]).permutation(len(names))[place]]


def _choice(rng: Rng, weights: dict[str, float]) -> str:
    return str(rng.choice(list(weights), p=list(weights.values())))


def _mechanism(name: str) -> Mechanism:
    return MECHANISMS[name] if name in MECHANISMS else LAWS[name][0]


def _pair(rng: Rng) -> tuple[str, list[str]]:
    """A scenario and two compatible mechanisms that it shows."""
    scenario = _choice(rng, PAIRS)
    regimes = LIFTED.get(scenario, ())
    able = [name for name, one in MECHANISMS.items() if scenario in one.scenarios or one.regime in regimes]
    while True:
        names = [str(name) for name in rng.choice(able, 2, replace=False)]
        if not any(set(names) <= group for group in INCOMPATIBLE):
            return scenario, names


def _table(rng: Rng) -> Law:
    """Draw the sizes of a table, its puck and mallets; other parameters are the simulator's defaults."""
    return Law(
        length=_about(rng, 1.8, 2.4, 3),
        width=_about(rng, 0.9, 1.2, 3),
        goal_width=_about(rng, 0.28, 0.38, 3),
        puck_radius=_about(rng, 0.028, 0.041, 4),
        mallet_radius=_about(rng, 0.045, 0.055, 4),
    )


def _about(rng: Rng, low: float, high: float, digits: int) -> float:
    return round(float(rng.uniform(low, high)), digits)


def _other_parameters(rng: Rng, law: Law) -> Law:
    """Draw other parameters: friction, drag, restitutions, and the gantry's six coefficients."""
    gantry = {name: getattr(law, name) * float(rng.uniform(0.85, 1.15)) for name in ("a1", "a2", "a3", "b1", "b2")}
    return replace(
        law,
        friction=float(rng.uniform(0.06, 0.22)),
        drag=float(rng.uniform(0.04, 0.25)),
        wall_restitution=float(rng.uniform(0.6, 0.85)),
        mallet_restitution=float(rng.uniform(0.55, 0.85)),
        **gantry,
    )


def _camera(rng: Rng) -> Camera:
    """Draw a camera with small errors; none repeats a position, because that is a mechanism."""
    return Camera(
        rate=float(round(rng.uniform(100.0, 150.0))),
        noise=_about(rng, 0.0003, 0.001, 5),
        jitter=float(rng.uniform(0.0, 0.0005)),
        dropped=float(rng.uniform(0.0, 0.03)),
        wild=float(rng.uniform(0.0, 0.005)),
        wild_by=float(rng.uniform(0.02, 0.08)),
    )


def _with(rng: Rng, kind: str, scenario: str, law: Law, names: list[str], camera: Camera | None) -> Case:
    """Make the case with its mechanisms and its key; the camera is drawn if none is given."""
    camera = camera or _camera(rng)
    hand = Hand(patience=4.0, at_posts=True) if scenario == "posts" else Hand()
    values, where, shares = {}, {}, {}
    for name in names:
        share = float(np.exp(rng.uniform(np.log(WEAKEST), np.log(STRONGEST))))
        change = _mechanism(name).draw(rng, share, law, scenario)
        law, camera, hand = replace(law, **change.law), replace(camera, **change.camera), replace(hand, **change.hand)
        values[name], where[name], shares[name] = change.values, change.where, share
    unlisted = kind == "unlisted"
    baseline = ("friction", "drag", "wall_restitution", "mallet_restitution", "a1", "a2", "a3", "b1", "b2")
    truth = {
        "kind": kind,
        "scenario": scenario,
        "verdict": {"nothing": "agrees", "parameters": "parameters_only"}.get(kind, "missing_physics"),
        "mechanisms": ["unlisted"] if unlisted else names,
        "regimes": [_mechanism(name).regime for name in names],
        "depends": list(LAWS[names[0]][1]) if unlisted else None,
        "law": names[0] if unlisted else None,
        "values": {} if unlisted else values,
        "where": {} if unlisted else where,
        "shares": shares,
        "baseline": {name: getattr(law, name) for name in baseline},
    }
    return Case(scenario, law, camera, hand, float(rng.uniform(0.00005, 0.00015)), truth)
