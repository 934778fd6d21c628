"""Rendered games before the eye: how often it knows where the puck is, and how often it errs though it says so.

python -m tests.sim2real.vision.track.games [SECONDS [SEED [PLAYER PLAYER]]]
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from itertools import islice

import numpy as np

from sim2real.camera.moments import simulated
from sim2real.camera.render.moment import Motion
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import View
from sim2real.vision.track.eye import Eye
from sim2real.vision.track.follow import Estimate
from sim2real.vision.trial.rendered import exact_locator, eye_for

RATE, PLAYERS = 120.0, ("veteran", "bank_shot")


@dataclass
class Judged:
    """Of what is known: how far off [m], the square of that in standard deviations, and the velocity's; and pictures
    without."""

    far: list[float] = field(default_factory=list)
    squares: list[float] = field(default_factory=list)
    speeds: list[float] = field(default_factory=list)
    unknown: int = 0

    def add(self, estimate: Estimate | None, truth: Motion) -> None:
        if estimate is None:
            self.unknown += 1
            return
        error, faster = estimate.place - truth[:2], estimate.velocity - truth[2:4]
        self.far.append(float(np.linalg.norm(error)))
        self.squares.append(float(error @ np.linalg.solve(estimate.covariance[:2, :2], error)))
        self.speeds.append(float(faster @ np.linalg.solve(estimate.covariance[2:, 2:], faster)))

    def __str__(self) -> str:
        mm, squares = 1e3 * np.array(self.far), np.array(self.squares)
        return (
            f"known in {len(mm)} pictures, unknown in {self.unknown}; mm: mean {mm.mean():.3f}, p99 "
            f"{np.percentile(mm, 99):.3f}, max {mm.max():.3f}; known and over 5 mm off: {(mm > 5.0).sum()}, over 4 "
            f"standard deviations: {(squares > 16.0).sum()}; within the 95 % ellipse: "
            f"{share_within(self.squares):.3f}, velocities: {share_within(self.speeds):.3f}"
        )


def share_within(squares: list[float]) -> float:
    """Of the 95 % ellipse, two numbers' chi-square."""
    return float((np.array(squares) < 5.991).mean())


def judge(pictures: int, seed: int, players: tuple[str, str] = PLAYERS) -> dict[str, Judged]:
    """The puck and the opponent's ring in the first pictures of a game, before an eye with the exact calibration."""
    table = Table.with_markers()
    renderer = Renderer(table, View.like_the_real_one(table.length, table.width), seed=seed)
    return judge_before(eye_for(renderer, exact_locator(table, renderer.view)), renderer, pictures, seed, players)


def judge_before(
    eye: Eye, renderer: Renderer, pictures: int, seed: int, players: tuple[str, str] = PLAYERS
) -> dict[str, Judged]:
    """The same before any eye, at RATE [Hz]."""
    judged = {"puck": Judged(), "ring": Judged()}
    moments = simulated("puckpilot/match-v0", players, seed, RATE)
    for number, moment in enumerate(islice(moments, pictures)):
        seen = eye.look(renderer.picture(moment, number), moment.time)
        if moment.puck:
            judged["puck"].add(seen.puck, moment.puck)
        assert moment.opponent
        judged["ring"].add(seen.opponent, moment.opponent)
    return judged


if __name__ == "__main__":
    seconds, number = (float(sys.argv[k]) if len(sys.argv) > k else default for k, default in ((1, 10.0), (2, 0.0)))
    who = (sys.argv[3], sys.argv[4]) if len(sys.argv) > 4 else PLAYERS
    for name, one in judge(int(seconds * RATE), int(number), who).items():
        print(f"{name}: {one}")
