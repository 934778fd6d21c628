"""Rendered games in front of the detector: how often it knows the puck's place, and how far that is off.

python -m tests.sim2real.vision.track.games [SECONDS [SEED [PLAYER PLAYER]]]
"""

from __future__ import annotations

import sys
from dataclasses import dataclass, field
from itertools import islice

import numpy as np

from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.camera.scene_states import simulated_states
from sim2real.vision.track.detector import Detector
from sim2real.vision.track.kalman_tracker import TrackState
from sim2real.vision.trial.rendered_calibration import detector_for, exact_locator

RATE, PLAYERS = 120.0, ("veteran", "bank_shot")


@dataclass
class Judged:
    """The errors of known states: of places [m], squared Mahalanobis distances of places and of velocities, and the
    number of pictures without a known state."""

    far: list[float] = field(default_factory=list)
    squares: list[float] = field(default_factory=list)
    speeds: list[float] = field(default_factory=list)
    unknown: int = 0

    def add(self, state: TrackState | None, truth: BodyState) -> None:
        if state is None:
            self.unknown += 1
            return
        error, faster = state.place - truth[:2], state.velocity - truth[2:4]
        self.far.append(float(np.linalg.norm(error)))
        self.squares.append(float(error @ np.linalg.solve(state.covariance[:2, :2], error)))
        self.speeds.append(float(faster @ np.linalg.solve(state.covariance[2:, 2:], faster)))

    def __str__(self) -> str:
        mm, squares = 1e3 * np.array(self.far), np.array(self.squares)
        return (
            f"known in {len(mm)} pictures, unknown in {self.unknown}; mm: mean {mm.mean():.3f}, p99 "
            f"{np.percentile(mm, 99):.3f}, max {mm.max():.3f}; known and over 5 mm off: {(mm > 5.0).sum()}, over 4 "
            f"standard deviations: {(squares > 16.0).sum()}; within the 95 % ellipse: "
            f"{share_within(self.squares):.3f}, velocities: {share_within(self.speeds):.3f}"
        )


def share_within(squares: list[float]) -> float:
    """The share of squared distances within the 95 % quantile of chi-square with two degrees of freedom."""
    return float((np.array(squares) < 5.991).mean())


def judge(pictures: int, seed: int, players: tuple[str, str] = PLAYERS) -> dict[str, Judged]:
    """The puck and the opponent's ring in the first pictures of a game, by a detector with the exact calibration."""
    table = Table.with_markers()
    renderer = Renderer(table, CameraView.like_the_real_one(table.length, table.width), seed=seed)
    return judge_before(detector_for(renderer, exact_locator(table, renderer.view)), renderer, pictures, seed, players)


def judge_before(
    detector: Detector, renderer: Renderer, pictures: int, seed: int, players: tuple[str, str] = PLAYERS
) -> dict[str, Judged]:
    """The same by any detector, at RATE [Hz]."""
    judged = {"puck": Judged(), "ring": Judged()}
    states = simulated_states("puckpilot/match-v0", players, seed, RATE)
    for number, state in enumerate(islice(states, pictures)):
        found = detector.detect(renderer.picture(state, number), state.time)
        if state.puck:
            judged["puck"].add(found.puck, state.puck)
        assert state.opponent
        judged["ring"].add(found.opponent, state.opponent)
    return judged


if __name__ == "__main__":
    seconds, number = (float(sys.argv[k]) if len(sys.argv) > k else default for k, default in ((1, 10.0), (2, 0.0)))
    who = (sys.argv[3], sys.argv[4]) if len(sys.argv) > 4 else PLAYERS
    for name, one in judge(int(seconds * RATE), int(number), who).items():
        print(f"{name}: {one}")
