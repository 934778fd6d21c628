"""How exact and how fast the vision is, on rendered pictures."""

from __future__ import annotations

import copy
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import cv2
import numpy as np

from sim2real.camera.render.moment import Moment, Motion
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.table import Surface, Table
from sim2real.camera.render.view import View
from sim2real.vision.calibrate.pose import camera_pose
from sim2real.vision.locate import Grid, Locator
from sim2real.vision.markers import find_markers
from sim2real.vision.track.bright import Bright
from sim2real.vision.track.eye import Eye
from sim2real.vision.track.puck import PuckFinder
from sim2real.vision.trial.baseline import centroid, report_centre
from sim2real.vision.trial.rendered import eye_for
from sim2real.vision.trial.rendered_calibration import estimated

WARP = Surface((0.0, -0.005, 0.008, 0.003, -0.002, -0.006))  # up to 5 mm, level in the middle
RATE = 120.0  # Hz
HALF = (0.3, 0.7)  # of a puck that is half hidden, how much is seen
INSET = 0.035  # m of a puck's centre from the walls
BEYOND_BEAM = 0.95  # m: pucks that the gantry can hide are nearer
HIDES = (-0.03, 0.16)  # m that the gantry is nearer to the camera than a puck that it hides
APART = 0.082  # m between puck and mallet at least
WAYS = ("disc", "report C.2", "centroid")
Look = Callable[[np.ndarray, Motion], dict[str, np.ndarray | None]]


@dataclass(frozen=True)
class Stage:
    """A warped table before a camera, and where a calibration from views of it has everything."""

    renderer: Renderer
    locator: Locator

    @classmethod
    def with_estimated_calibration(cls, seed: int) -> Stage:
        """`seed`: of the calibration's errors and of the pictures' noise."""
        table = replace(Table.with_markers(), surface=WARP)
        view = View.like_the_real_one(table.length, table.width)
        setup, solved = estimated(table, view, seed)
        renderer = Renderer(table, view, seed=seed)
        corners = find_markers(renderer.picture(Moment()), setup.camera, setup.dictionary)
        pose = camera_pose(setup, solved.scene, corners)
        return cls(renderer, Locator(setup.camera, pose.motion, solved.scene.surface, solved.scene.bend))


def errors(stage: Stage, pictures: int, hidden: bool, seed: int) -> dict[str, np.ndarray]:
    """By the name of a way, how far off (n,) [m] it has the puck where it is clear, or half hidden, in about so many
    pictures; where it finds none, NaN."""
    rng, look = np.random.default_rng(seed), _looker(stage)
    moments = _half_hidden(stage, rng) if hidden else _clear(stage, rng)
    rows: dict[str, list[float]] = {way: [] for way in WAYS}
    image = np.zeros(stage.renderer.view.size[::-1], np.uint8)
    for number, moment in zip(range(pictures), moments, strict=False):
        assert moment.puck is not None
        box = stage.renderer.box_of(moment, 40)
        part = slice(box.top, box.bottom), slice(box.left, box.right)
        image[part] = stage.renderer.picture(moment, number, box)
        for way, centre in look(image, moment.puck).items():
            rows[way].append(np.nan if centre is None else float(np.linalg.norm(centre - moment.puck[:2])))
        image[part] = 0
    return {way: np.array(far) for way, far in rows.items()}


def speed(stage: Stage, pictures: int, seed: int) -> dict[str, np.ndarray]:
    """Seconds (pictures, 2) on one core that a look at a picture takes in which nothing is known beforehand, and at one
    in which puck and ring are near to where they should be: at a picture that has just come, as in play, and at the
    same once more, when picture and program are in the processor's cache."""
    table, rng = stage.renderer.table, np.random.default_rng(seed)
    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        eye, took = eye_for(stage.renderer, stage.locator), {"full frame": [], "region of interest": []}
        for number, start in enumerate(_clear(stage, rng)):
            if number == pictures:
                break
            assert start.puck is not None
            x, y = rng.uniform((0.5 * table.length + 0.1, 0.1), (table.length - 0.1, table.width - 0.1))
            moment = replace(start, opponent=Motion(x, y, *rng.normal(0.0, 1.0, 2)), mallet=Motion(0.06, 0.5))
            fresh = copy.deepcopy(eye)
            for k in range(3):  # after two pictures it is known where to look
                later = replace(
                    moment, **{name: getattr(moment, name).after(k / RATE) for name in ("puck", "opponent")}
                )
                image, again = stage.renderer.picture(later, number), copy.deepcopy(fresh)
                looks = [_seconds(one, image, k / RATE) for one in (fresh, again)]
                if k != 1:
                    took["region of interest" if k else "full frame"].append(looks)
    finally:
        cv2.setNumThreads(before)
    return {name: np.array(every) for name, every in took.items()}


def _seconds(eye: Eye, image: np.ndarray, at: float) -> float:
    begin = time.perf_counter()
    eye.look(image, at)
    return time.perf_counter() - begin


def _looker(stage: Stage) -> Look:
    """Finds the puck in all ways. The baselines are told which outline is the puck's, and where it was."""
    table, size = stage.renderer.table, stage.renderer.view.size
    bright = Bright(stage.locator, size, table.length, table.width, table.ring_height)
    places = Grid(stage.locator, table.puck_height, size).places
    finder = PuckFinder(places, table.puck_radius)

    def look(image: np.ndarray, puck: Motion) -> dict[str, np.ndarray | None]:
        blobs, truth = bright.blobs(image), np.array(puck[:2])
        discs = finder.find(image, blobs)
        contours = [places(blob.outline.astype(float)) for blob in blobs]
        if not contours:
            return dict.fromkeys(WAYS)
        nearest = min(contours, key=lambda one: float(np.linalg.norm(one.mean(axis=0) - truth)))
        before = np.array(puck.after(-1.0 / RATE)[:2])
        found = (
            discs[0].centre if discs else None,
            report_centre(nearest, table.puck_radius, before),
            centroid(nearest),
        )
        return dict(zip(WAYS, found, strict=True))

    return look


def _clear(stage: Stage, rng: np.random.Generator) -> Iterator[Moment]:
    """Pucks all over the table that nothing hides."""
    table = stage.renderer.table
    while True:
        x, y = rng.uniform((0.12, INSET), (table.length - INSET, table.width - INSET))
        yield Moment(puck=Motion(x, y, *rng.normal(0.0, 2.0, 2)))


def _half_hidden(stage: Stage, rng: np.random.Generator) -> Iterator[Moment]:
    """Pucks of which the gantry hides about half."""
    table, renderer = stage.renderer.table, stage.renderer
    while True:
        x, y = rng.uniform((0.1, INSET), (BEYOND_BEAM, table.width - INSET))
        puck = Motion(x, y, *rng.normal(0.0, 2.0, 2))
        mallet = Motion(x - rng.uniform(*HIDES), rng.uniform(0.1, table.width - 0.1))
        if np.hypot(mallet.x - x, mallet.y - y) < APART or mallet.x < table.mallet_radius:
            continue
        alone, both = Moment(puck=puck), Moment(puck=puck, mallet=mallet)
        box = renderer.box_of(alone, 8)
        whole, left = renderer.light(alone, box), renderer.light(both, box)
        shines = whole > 0.5 * whole.max()
        if HALF[0] <= (left[shines] > 0.5 * whole.max()).mean() <= HALF[1]:
            yield both
