"""A robot's mallet alone on the table: random targets at random voltages, by plans or by what the motors are given."""

from __future__ import annotations

from dataclasses import replace
from math import inf

import numpy as np

from sim2real.study.independent_table.physics.gantry import MOTOR
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.physics.volts import Plan, profile
from sim2real.study.independent_table.recorder.aim import plan_to
from sim2real.study.independent_table.recorder.scene import FINE, HOME, TICK, Scene
from sim2real.study.independent_table.simulate import run

LOOP = 1e-3  # s, the motors' driver is told anew this often
MARGIN = 0.06  # m, between a target and the reach of the mallet's rim to a wall
FARTHEST = 0.45  # of length, of a target


def roam(law: Law, seed: int, seconds: float, driven: bool = False, dt: float = 1e-5) -> Scene:
    """Simulate a mallet that is sent to a new place every 0.2 to 0.5 s.

    Not driven: a new plan every TICK, as a robot sends them, of which `commands` holds each. Driven: one plan for each
    target, told to the motors LOOP by LOOP (`drive`), with the path that the baseline law expects (`expected`).
    """
    rng = np.random.default_rng(seed)
    believed = Law()
    mallets = np.zeros((1, 6))
    mallets[0, [0, 3]] = HOME[0] * law.length, HOME[1] * law.width
    target, volts, ticks_left, clock = (0.0, 0.0), (0.0, 0.0), 0, 0.0
    before: list[tuple[float, Plan | None]] = []
    pieces, expected, commands, drive = [], [], [], []
    while clock < seconds - 1e-9:
        if ticks_left <= 0:
            target, volts = choose(law, rng)
            ticks_left = int(rng.integers(2, 6))
        ticks = ticks_left if driven else 1
        lasts, ticks_left = min(ticks * TICK, seconds - clock), ticks_left - ticks
        plan = plan_to(believed, list(mallets[0, -MOTOR:]), target, volts)
        told = step_by_step(plan, lasts) if driven else [(0.0, plan)]
        if driven:
            drive += [(clock + start, values[0], values[1]) for start, values in told]
            model = run(believed, None, mallets[:, -MOTOR:], [told], lasts, dt, sample=FINE)
            expected.append(model.mallets[0, :-1][:, [0, 3]])
        else:
            commands.append((clock, *target, *plan))
        trace = run(law, None, mallets, [before + told], lasts, dt, sample=FINE, clock=clock)
        before = [(start - lasts, values) for start, values in told[-1:]]
        mallets = trace.end_mallets
        pieces.append(trace.mallets[:, :-1][:, :, [0, 3]])
        clock += lasts
    path = np.concatenate(pieces, axis=1)
    scene = Scene(np.arange(path.shape[1]) * FINE, np.full((path.shape[1], 2), np.nan), path, commands, [])
    return replace(scene, drive=drive, expected=np.concatenate(expected)) if driven else scene


def choose(law: Law, rng: np.random.Generator) -> tuple[tuple[float, float], tuple[float, float]]:
    """A target on the robot's side and the two magnitudes of voltage for the way there."""
    nearest = law.mallet_radius + MARGIN
    target = rng.uniform(nearest, FARTHEST * law.length), rng.uniform(nearest, law.width - nearest)
    return target, (float(rng.uniform(2.5, 10.0)), float(rng.uniform(2.5, 10.0)))


def step_by_step(plan: Plan, lasts: float) -> list[tuple[float, Plan]]:
    """The volts of a plan at each LOOP, held until the next: as many plans of constant volts as there are changes."""
    volts_x, volts_y, tx1, ty1, tx2, ty2 = plan
    steps: list[tuple[float, Plan]] = []
    for k in range(round(lasts / LOOP)):
        pair = profile(volts_x, tx1, tx2, k * LOOP), profile(volts_y, ty1, ty2, k * LOOP)
        if not steps or steps[-1][1][:2] != pair:
            steps.append((k * LOOP, (*pair, inf, inf, inf, inf)))
    return steps
