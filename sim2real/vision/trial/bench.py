"""Measure the errors and the run time of the vision on rendered pictures."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np

from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import RenderedSurface, Table
from sim2real.camera.render.view import CameraView
from sim2real.vision.calibrate.pose import camera_pose
from sim2real.vision.locate import Locator, PlaceGrid
from sim2real.vision.markers import find_markers
from sim2real.vision.track.blobs import BlobDetector
from sim2real.vision.track.detector import Detector
from sim2real.vision.track.film import Film
from sim2real.vision.track.puck import PuckFinder
from sim2real.vision.trial.baseline import centroid, report_centre
from sim2real.vision.trial.rendered_calibration import detector_for, estimated_calibration

WARP = RenderedSurface((0.0, -0.005, 0.008, 0.003, -0.002, -0.006))  # up to 5 mm, level in the middle
RATE = 120.0  # Hz
HALF = (0.3, 0.7)  # visible share of a puck that counts as half hidden
INSET = 0.035  # m, least distance of a puck's centre from the walls
BEYOND_BEAM = 0.95  # m, greatest x of a puck that the gantry can hide
HIDES = (-0.03, 0.16)  # m by which the gantry is nearer to the camera than a puck that it hides
APART = 0.082  # m, least distance between puck and mallet
METHODS = ("disc", "report C.2", "centroid")
FindPuck = Callable[[np.ndarray, BodyState], dict[str, np.ndarray | None]]


@dataclass(frozen=True)
class BenchmarkTable:
    """A warped table in front of a camera, with an estimated calibration."""

    renderer: Renderer
    locator: Locator

    @classmethod
    def with_estimated_calibration(cls, seed: int) -> BenchmarkTable:
        """Render the views, estimate the calibration and locate the camera. `seed` draws the calibration's errors and
        the pictures' noise."""
        table = replace(Table.with_markers(), surface=WARP)
        view = CameraView.like_the_real_one(table.length, table.width)
        setup, fit = estimated_calibration(table, view, seed)
        renderer = Renderer(table, view, seed=seed)
        corners = find_markers(renderer.picture(SceneState()), setup.camera, setup.dictionary)
        pose = camera_pose(setup, fit.geometry, corners)
        return cls(renderer, Locator(setup.camera, pose.motion, fit.geometry.surface, fit.geometry.warp))


def centre_errors(bench: BenchmarkTable, pictures: int, hidden: bool, seed: int) -> dict[str, np.ndarray]:
    """Errors of the puck's centre (n,) [m] by the name of the method, in n pictures in which the puck is clear or half
    hidden; NaN where the method finds no puck."""
    rng, find = np.random.default_rng(seed), _all_methods(bench)
    states = _half_hidden(bench, rng) if hidden else _clear(bench, rng)
    rows: dict[str, list[float]] = {method: [] for method in METHODS}
    image = np.zeros(bench.renderer.view.size[::-1], np.uint8)
    for number, state in zip(range(pictures), states, strict=False):
        assert state.puck is not None
        box = bench.renderer.box_of(state, 40)
        part = slice(box.top, box.bottom), slice(box.left, box.right)
        image[part] = bench.renderer.picture(state, number, box)
        for method, centre in find(image, state.puck).items():
            rows[method].append(np.nan if centre is None else float(np.linalg.norm(centre - state.puck[:2])))
        image[part] = 0
    return {method: np.array(far) for method, far in rows.items()}


def detection_times(bench: BenchmarkTable, pictures: int, seed: int) -> dict[str, np.ndarray]:
    """Detection times (pictures, 2) [s] on one core, for a full frame, in which nothing is known beforehand, and for
    search regions round the predicted puck and ring. The first column is of a new picture, as in play, the second of
    the same picture again, when picture and program are in the processor's cache."""
    table, rng = bench.renderer.table, np.random.default_rng(seed)
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        detector, took = detector_for(bench.renderer, bench.locator), {"full frame": [], "region of interest": []}
        for number, start in enumerate(_clear(bench, rng)):
            if number == pictures:
                break
            assert start.puck is not None
            x, y = rng.uniform((0.5 * table.length + 0.1, 0.1), (table.length - 0.1, table.width - 0.1))
            state = replace(start, opponent=BodyState(x, y, *rng.normal(0.0, 1.0, 2)), mallet=BodyState(0.06, 0.5))
            fresh = copy.deepcopy(detector)
            for k in range(3):  # the third picture has search regions
                later = replace(state, **{name: getattr(state, name).after(k / RATE) for name in ("puck", "opponent")})
                image, again = bench.renderer.picture(later, number), copy.deepcopy(fresh)
                times = [_seconds(one, image, k / RATE) for one in (fresh, again)]
                if k != 1:
                    took["region of interest" if k else "full frame"].append(times)
    finally:
        cv2.setNumThreads(before)
    return {name: np.array(every) for name, every in took.items()}


def _seconds(detector: Detector, image: np.ndarray, at: float) -> float:
    begin = time.perf_counter()
    detector.detect(image, at)
    return time.perf_counter() - begin


def _all_methods(bench: BenchmarkTable) -> FindPuck:
    """A function that finds the puck with all methods. The baselines are given the puck's outline and its last
    place."""
    table, size = bench.renderer.table, bench.renderer.view.size
    bright = BlobDetector(bench.locator, size, table.length, table.width, table.ring_height)
    places = PlaceGrid(bench.locator, table.puck_height, size).places
    finder = PuckFinder(places, Film.known(table.puck_radius))

    def find(image: np.ndarray, puck: BodyState) -> dict[str, np.ndarray | None]:
        blobs, truth = bright.blobs(image), np.array(puck[:2])
        discs = finder.find(image, blobs)
        contours = [places(blob.outline.astype(float)) for blob in blobs]
        if not contours:
            return dict.fromkeys(METHODS)
        nearest = min(contours, key=lambda one: float(np.linalg.norm(one.mean(axis=0) - truth)))
        before = np.array(puck.after(-1.0 / RATE)[:2])
        found = (
            discs[0].centre if discs else None,
            report_centre(nearest, table.puck_radius, before),
            centroid(nearest),
        )
        return dict(zip(METHODS, found, strict=True))

    return find


def _clear(bench: BenchmarkTable, rng: np.random.Generator) -> Iterator[SceneState]:
    """Endless states with a puck anywhere on the table that nothing hides."""
    table = bench.renderer.table
    while True:
        x, y = rng.uniform((0.12, INSET), (table.length - INSET, table.width - INSET))
        yield SceneState(puck=BodyState(x, y, *rng.normal(0.0, 2.0, 2)))


def _half_hidden(bench: BenchmarkTable, rng: np.random.Generator) -> Iterator[SceneState]:
    """Endless states with a puck of which the gantry hides about half."""
    table, renderer = bench.renderer.table, bench.renderer
    while True:
        x, y = rng.uniform((0.1, INSET), (BEYOND_BEAM, table.width - INSET))
        puck = BodyState(x, y, *rng.normal(0.0, 2.0, 2))
        mallet = BodyState(x - rng.uniform(*HIDES), rng.uniform(0.1, table.width - 0.1))
        if np.hypot(mallet.x - x, mallet.y - y) < APART or mallet.x < table.mallet_radius:
            continue
        alone, both = SceneState(puck=puck), SceneState(puck=puck, mallet=mallet)
        box = renderer.box_of(alone, 8)
        whole, left = renderer.light(alone, box), renderer.light(both, box)
        shines = whole > 0.5 * whole.max()
        if HALF[0] <= (left[shines] > 0.5 * whole.max()).mean() <= HALF[1]:
            yield both
