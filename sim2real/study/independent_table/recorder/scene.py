"""The scenes of recordings: launches by hand, and a robot that rallies.

A scene is simulated in ticks of 0.1 s and joined into arrays, the truth that camera and encoders observe.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from math import atan2, cos, hypot, pi, sin

import numpy as np

from sim2real.study.independent_table.physics.gantry import MOTOR
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.physics.volts import Plan
from sim2real.study.independent_table.recorder.aim import plan_to
from sim2real.study.independent_table.simulate import Contact, run

TICK = 0.1  # s, period of new plans
FINE = 1e-4  # s, spacing of the truth (interpolation cuts a bounce by about 0.1 mm)
HAND = 0.6  # s, for which the puck is hidden when a hand takes it
HOME = (0.22, 0.5)  # shares of length and width: where the robot waits
REACH = 0.42  # share of the length: the robot's side


@dataclass
class Scene:
    """The truth every FINE seconds, `commands` as sent (t, x_f, y_f, then the plan), contacts (t from the start).

    If the motors got volts instead of plans: `drive`, (t, V_x, V_y) at every change, and the mallet's `expected` path.
    """

    t: np.ndarray  # (n,)
    puck: np.ndarray  # (n, 2), NaN while there is none
    mallets: np.ndarray  # (k, n, 2)
    commands: list[tuple[float, ...]]
    contacts: list[Contact]
    drive: list[tuple[float, float, float]] | None = None
    expected: np.ndarray | None = None  # (n, 2)


@dataclass
class Robot:
    """A player of one mallet that waits at home and drives through the puck when that comes within reach."""

    law: Law
    rng: np.random.Generator
    opponent: bool = False
    believed: Law = field(default_factory=Law)  # the law that its plans assume
    target: tuple[float, float] = (0.0, 0.0)
    volts: tuple[float, float] = (6.0, 6.0)
    ticks_left: int = 0

    def act(self, mallet: np.ndarray, puck: np.ndarray) -> tuple[tuple[float, float], Plan]:
        """Target and plan for the next tick, from the mallet's state (6 or 12,) and the puck's (6,)."""
        if self.ticks_left <= 0:
            self.choose(mallet, puck)
        self.ticks_left -= 1
        return self.target, plan_to(self.believed, list(mallet[-MOTOR:]), self.target, self.volts)

    def choose(self, mallet: np.ndarray, puck: np.ndarray) -> None:
        """Choose a target for some ticks: the puck's future place if reachable, else home."""
        own = -1.0 if self.opponent else 1.0

        def ahead(x: float) -> float:  # as seen from this player's wall
            return self.law.length - x if self.opponent else x

        lead = self.rng.uniform(0.1, 0.25)
        x, y = puck[0] + lead * puck[2], puck[1] + lead * puck[3]
        margin = self.law.mallet_radius + 0.06
        low, high = margin, REACH * self.law.length
        reachable = low + 0.05 < ahead(x) < high and margin < y < self.law.width - margin
        self.volts = (float(self.rng.uniform(6.0, 9.0)), float(self.rng.uniform(5.0, 8.0)))
        if np.isfinite(x) and reachable and ahead(mallet[0]) < ahead(x) - 0.03:
            follow = ahead(x) + self.rng.uniform(0.0, 0.12)
            aim_x, aim_y, self.ticks_left = min(follow, high), y, 3
        else:
            jitter = self.rng.normal(0.0, 0.04, 2)
            aim_x = HOME[0] * self.law.length + jitter[0]
            follow_y = 0.5 * (puck[1] - 0.5 * self.law.width) if np.isfinite(puck[1]) else 0.0
            aim_y, self.ticks_left = HOME[1] * self.law.width + follow_y + jitter[1], 2
        aim_x = float(np.clip(aim_x, low, high))
        self.target = (
            aim_x if own > 0 else self.law.length - aim_x,
            float(np.clip(aim_y, margin, self.law.width - margin)),
        )


@dataclass(frozen=True)
class Hand:
    """The person who launches the puck; a puck that is slow, gone, or older than `patience` is launched again."""

    fastest: float = 3.0  # m/s, highest speed of a launch; the lowest is 0.3 of it
    patience: float = 8.0  # s
    spin: float = 0.0  # rad/s, standard deviation of the puck's spin at launch
    at_posts: bool = False  # whether launches are aimed at the goal posts


def launch(law: Law, rng: np.random.Generator, mallets: np.ndarray, hand: Hand) -> np.ndarray:
    """Draw the start of a puck launched by hand, away from walls and mallets.

    Without mallets it starts anywhere in any direction; otherwise in the far half, towards the robot.
    """
    nearest, spread = (0.5, 1.0) if len(mallets) else (0.1, pi)
    while True:
        x, y = rng.uniform(nearest, 0.9) * law.length, rng.uniform(0.15, 0.85) * law.width
        if all(hypot(x - m[0], y - m[3]) > 3.0 * law.mallet_radius for m in mallets):
            break
    speed, heading = hand.fastest * rng.uniform(0.3, 1.0), pi + rng.uniform(-spread, spread)
    if hand.at_posts:
        post_x = law.length if rng.uniform() < 0.5 else 0.0
        post_y = 0.5 * (law.width + (law.goal_width if rng.uniform() < 0.5 else -law.goal_width))
        heading = atan2(post_y + law.puck_radius * rng.uniform(-1.0, 1.0) - y, post_x - x)
    spin = hand.spin * rng.standard_normal() if hand.spin else 0.0
    return np.array([x, y, speed * cos(heading), speed * sin(heading), spin])


def play(law: Law, seed: int, seconds: float, players: int, hand: Hand | None = None, dt: float = 1e-5) -> Scene:
    """Simulate `seconds` with 0..2 driven mallets and a hand that relaunches the puck."""
    hand = Hand() if hand is None else hand
    rng = np.random.default_rng(seed)
    robots = [Robot(law, rng, opponent=k == 1) for k in range(players)]
    mallets = np.zeros((players, 6))
    for k in range(players):
        mallets[k, [0, 3]] = abs((k * law.length) - HOME[0] * law.length), HOME[1] * law.width
    puck, age, away = np.full(6, np.nan), 0.0, 0.0
    paths, commands, contacts = [], [], []
    last: list[Plan | None] = [None] * players
    for tick in range(round(seconds / TICK)):
        slow = hypot(puck[2], puck[3]) < 0.08
        if away <= 0.0 and (np.isnan(puck[0]) or slow or age > hand.patience):
            puck, away = np.full(6, np.nan), HAND if tick else TICK
        if away > 0.0:
            away -= TICK
            if away <= 1e-9:
                puck, age, away = launch(law, rng, mallets, hand), 0.0, 0.0
        plans = []
        before, last = last, []
        for k, robot in enumerate(robots):
            target, plan = robot.act(mallets[k], puck)
            last.append(plan)
            plans.append([(-TICK, before[k]), (0.0, plan)])  # the previous plan continues until a delayed one starts
            if k == 0:
                commands.append((tick * TICK, *target, *plan))
        trace = run(law, None if np.isnan(puck[0]) else puck, mallets, plans, TICK, dt, sample=FINE, clock=tick * TICK)
        puck, mallets, age = trace.end_puck, trace.end_mallets, age + TICK
        paths.append((trace.puck[:-1, :2], trace.mallets[:, :-1, [0, 3]]))
        contacts += [c._replace(t=c.t + tick * TICK) for c in trace.contacts]
    puck_path = np.concatenate([puck for puck, _ in paths])
    mallet_paths = np.concatenate([mallet for _, mallet in paths], axis=1)
    return Scene(np.arange(len(puck_path)) * FINE, puck_path, mallet_paths, commands, contacts)
