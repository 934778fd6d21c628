"""Pictures of a table without a puck but full of reflections, as often as asked: how many pucks are seen there?

    python -m tests.sim2real.vision.track.glints [FRAMES [SEED]]

Each scene lasts LASTS pictures in which gantry and opponent move, glints stay or move with them. The beam's streak
is in every picture that has a gantry.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain, islice

import numpy as np

from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import LOW_RING, STANDARD_RING, Glint, Table
from sim2real.camera.render.view import CameraView
from sim2real.vision.trial.rendered_calibration import detector_for, exact_locator

LASTS = 10  # pictures of a geometry
EVERY = 1.0 / 120.0  # s
MOST = 6  # glints at once


def scenes(seed: int, table: Table) -> Iterator[list[SceneState]]:
    """Endless scenes of LASTS states each."""
    rng = np.random.default_rng(seed)
    while True:
        opponent = _mover(rng, (1.06, 1.94), table) if rng.random() < 0.5 else None
        mallet = _mover(rng, (0.06, 0.94), table) if rng.random() < 0.8 else None
        glints = [_glint(rng, table) for _ in range(rng.integers(1, MOST + 1))]
        drifts = rng.normal(0.0, 1.0, (len(glints), 2)) * (rng.random((len(glints), 1)) < 0.5)
        yield [
            SceneState(
                time,
                opponent=opponent and _kept(opponent.after(time), table),
                mallet=mallet and _kept(mallet.after(time), table),
                glints=tuple(
                    replace(glint, x=glint.x + time * x, y=glint.y + time * y)
                    for glint, (x, y) in zip(glints, drifts, strict=True)
                ),
            )
            for time in EVERY * np.arange(LASTS)
        ]


def pucks_seen(frames: int, seed: int) -> list[tuple[int, np.ndarray]]:
    """Number of the picture and place [m] of all pucks in so many pictures; half of them with a low ring."""
    seen = []
    for number, height in enumerate((STANDARD_RING, LOW_RING)):
        table = replace(Table.with_markers(), ring_height=height)
        renderer = Renderer(table, CameraView.like_the_real_one(table.length, table.width), seed=seed)
        detector = detector_for(renderer, exact_locator(table, renderer.view))
        states = chain.from_iterable(scenes(2 * seed + number, table))
        for k, state in enumerate(islice(states, frames // 2)):
            puck = detector.detect(renderer.picture(state, k), k * EVERY).puck
            if puck is not None:
                seen.append((k + number * (frames // 2), puck.place))
    return seen


def _mover(rng: np.random.Generator, along: tuple[float, float], table: Table) -> BodyState:
    x, y = rng.uniform((along[0], 0.06), (along[1], table.width - 0.06))
    vx, vy = rng.normal(0.0, 1.5, 2)
    return BodyState(x, y, vx, vy)


def _kept(motion: BodyState, table: Table) -> BodyState:
    radius = table.mallet_radius
    x, y = np.clip(motion[:2], radius, (table.length - radius, table.width - radius))
    return motion._replace(x=x, y=y)


def _glint(rng: np.random.Generator, table: Table) -> Glint:
    """A spot of 2 to 15 mm, as of a lamp in the table, or a streak of up to 150 by 4 mm, as along a wall or a beam."""
    x, y = rng.uniform((0.0, 0.0), (table.length, table.width))
    level = rng.uniform(60.0, 250.0)
    if rng.random() < 0.6:
        half_x, half_y = np.exp(rng.uniform(np.log(0.002), np.log(0.015), 2))
        return Glint(x, y, half_x, half_y, level)
    long, thin = rng.uniform(0.01, 0.15), rng.uniform(0.001, 0.004)
    half_x, half_y = (long, thin) if rng.random() < 0.5 else (thin, long)
    return Glint(x, y, half_x, half_y, level)


if __name__ == "__main__":
    asked = int(sys.argv[1]) if len(sys.argv) > 1 else 10_000
    found = pucks_seen(asked, int(sys.argv[2]) if len(sys.argv) > 2 else 1)
    print(f"{len(found)} pucks in {asked} pictures of a table without one")
    for picture, place in found[:20]:
        print(f"picture {picture}: ({place[0]:.3f}, {place[1]:.3f})")
    raise SystemExit(bool(found))
