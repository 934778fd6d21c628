"""A robot's mallet alone on the table: random targets with random voltages, by plans or by a log of motor volts."""

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

LOOP = 1e-3  # s, period of the motor driver's updates
MARGIN = 0.06  # m, least gap between the mallet's rim and a wall at a target
FARTHEST = 0.45  # share of the length, largest x of a target


def roam(law: Law, seed: int, seconds: float, driven: bool = False, dt: float = 1e-5) -> Scene:
    """Simulate a mallet that moves to a new target every 0.2 to 0.5 s.

    Not `driven`: a new plan every TICK, as a robot sends them, recorded in `commands`. `driven`: one plan for each
    target, sent to the motors as volts at every LOOP (`drive`), with the path under the baseline law (`expected`).
    """
    rng = np.random.default_rng(seed)
    believed = Law()
    mallets = np.zeros((1, 6))
    mallets[0, [0, 3]] = HOME[0] * law.length, HOME[1] * law.width
    target, volts, ticks_left, clock = (0.0, 0.0), (0.0, 0.0), 0, 0.0
    before: list[tuple[float, Plan | None]] = []
    paths, expected, commands, drive = [], [], [], []
    while clock < seconds - 1e-9:
        if ticks_left <= 0:
            target, volts = choose(law, rng)
            ticks_left = int(rng.integers(2, 6))
        ticks = ticks_left if driven else 1
        lasts, ticks_left = min(ticks * TICK, seconds - clock), ticks_left - ticks
        plan = plan_to(believed, list(mallets[0, -MOTOR:]), target, volts)
        orders = step_by_step(plan, lasts) if driven else [(0.0, plan)]
        if driven:
            drive += [(clock + start, values[0], values[1]) for start, values in orders]
            model = run(believed, None, mallets[:, -MOTOR:], [orders], lasts, dt, sample=FINE)
            expected.append(model.mallets[0, :-1][:, [0, 3]])
        else:
            commands.append((clock, *target, *plan))
        trace = run(law, None, mallets, [before + orders], lasts, dt, sample=FINE, clock=clock)
        before = [(start - lasts, values) for start, values in orders[-1:]]
        mallets = trace.end_mallets
        paths.append(trace.mallets[:, :-1][:, :, [0, 3]])
        clock += lasts
    path = np.concatenate(paths, axis=1)
    scene = Scene(np.arange(path.shape[1]) * FINE, np.full((path.shape[1], 2), np.nan), path, commands, [])
    return replace(scene, drive=drive, expected=np.concatenate(expected)) if driven else scene


def choose(law: Law, rng: np.random.Generator) -> tuple[tuple[float, float], tuple[float, float]]:
    """Draw a target on the robot's side and the two magnitudes of voltage."""
    nearest = law.mallet_radius + MARGIN
    target = rng.uniform(nearest, FARTHEST * law.length), rng.uniform(nearest, law.width - nearest)
    return target, (float(rng.uniform(2.5, 10.0)), float(rng.uniform(2.5, 10.0)))


def step_by_step(plan: Plan, lasts: float) -> list[tuple[float, Plan]]:
    """Sample the volts of a plan at every LOOP, held until the next; one plan of constant volts for each change."""
    volts_x, volts_y, tx1, ty1, tx2, ty2 = plan
    steps: list[tuple[float, Plan]] = []
    for k in range(round(lasts / LOOP)):
        pair = profile(volts_x, tx1, tx2, k * LOOP), profile(volts_y, ty1, ty2, k * LOOP)
        if not steps or steps[-1][1][:2] != pair:
            steps.append((k * LOOP, (*pair, inf, inf, inf, inf)))
    return steps
