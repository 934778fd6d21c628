"""Delays and clock errors that are put into the twin come back: emulated board, independent plant, camera."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from puckpilot_env.variants import find_variant
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import SceneState
from sim2real.recording.folder import Stream
from sim2real.table.backends import make_backend
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.loop import home_of
from sim2real.table.latency.injection import truth, twin_options
from sim2real.table.latency.measure import Measurement, measure
from sim2real.table.latency.part import Part
from sim2real.table.latency.parts import parts_of_measurement, parts_of_recording
from sim2real.table.live_table import LiveTable
from sim2real.table.mallet_driver import AHEAD
from sim2real.table.twin.picture_camera import PictureCamera
from sim2real.table.twin.twin import Twin

SECONDS = 7.0
INJECTED = {"camera": 0.033, "drift": -50.0, "line": 0.003, "crystal": 40.0, "gantry": 0.003}


def measured(injected: dict[str, float], seconds: float = SECONDS) -> Measurement:
    game = GameRecord(find_variant("match-v0"))
    with make_backend("twin", game, opponent="still", **twin_options(injected, game.p)) as table:
        assert isinstance(table, LiveTable)
        return measure(table, game.p, home_of(game.p), seconds)


class RingOnRobot(Renderer):
    """Draws the opponent's mallet, with its ring, where the robot's is, and none else."""

    def picture(self, state: SceneState, number: int) -> np.ndarray:
        return super().picture(replace(state, opponent=state.mallet, mallet=None), number)


def by_name(parts: list[Part]) -> dict[str, Part]:
    return {one.name: one for one in parts}


@pytest.fixture(scope="module")
def everything() -> Measurement:
    return measured(INJECTED)


@pytest.mark.slow
def test_all_injected_delays_come_back_together(everything: Measurement) -> None:
    stamps = everything.recording.streams()["frames"].t
    true = truth(INJECTED, 0.5 * float(stamps[0] + stamps[-1]))
    found = by_name(parts_of_measurement(everything))
    for name, value in true.items():
        part = found[name]
        assert part.value == pytest.approx(value, abs=20.0 if part.unit == "ppm" else 5e-4), name
        assert part.low is not None and part.high is not None and part.low <= value <= part.high, name
    total = true["frame"] + AHEAD
    assert found["total"].value == pytest.approx(total, abs=1e-3)  # the feedback makes up for the gantry


@pytest.mark.slow
@pytest.mark.parametrize("late", [0.0, 0.06])
def test_the_least_and_the_greatest_delay_of_the_camera_come_back(late: float) -> None:
    found = by_name(parts_of_measurement(measured({"camera": late}, 4.0)))
    assert found["camera"].value == pytest.approx(late, abs=5e-4)
    assert found["camera_drift"].value == pytest.approx(0.0, abs=20.0)
    assert found["frame"].value == pytest.approx(late + 0.006, abs=5e-4)
    assert abs(found["camera"].high - found["camera"].low) < 1e-3  # type: ignore[operator]


@pytest.mark.slow
@pytest.mark.long
def test_the_opponents_ring_on_the_robots_mallet_is_seen_in_pictures() -> None:
    game = GameRecord(find_variant("match-v0"))
    options = twin_options({"camera": 0.02}, game.p)
    with make_backend("twin", game, opponent="still", camera="pictures", **options) as table:
        assert isinstance(table, Twin)
        make_camera = table._make_camera

        def with_the_ring(seed: int) -> PictureCamera:
            camera = make_camera(seed)
            assert isinstance(camera, PictureCamera)
            camera.renderer = RingOnRobot(camera.rendered.table, camera.rendered.view)
            return camera

        table._make_camera = with_the_ring
        found = by_name(parts_of_measurement(measure(table, game.p, home_of(game.p), 4.0)))
    assert found["camera"].value == pytest.approx(0.02, abs=5e-4)


@pytest.mark.slow
def test_without_a_ring_the_camera_is_not_determined(everything: Measurement) -> None:
    frames = everything.recording.streams()["frames"]
    blank = np.full(frames.rows, np.nan)
    hidden = Stream({**frames.columns, "robot_x": blank, "robot_y": blank})
    without = replace(everything, recording=replace(everything.recording, frames=hidden))
    found = by_name(parts_of_measurement(without))
    for name in ("camera", "camera_drift", "frame"):
        assert not found[name].determined and "reflective ring" in found[name].why
    assert found["total"].why == "it takes frame" and found["command"].determined


@pytest.mark.slow
def test_the_same_measurement_as_a_recording_says_the_same(everything: Measurement) -> None:
    live, later = by_name(parts_of_measurement(everything)), by_name(parts_of_recording(everything.recording))
    for name in ("camera", "camera_drift", "command", "follow"):
        near = 0.01 if live[name].unit == "ppm" else 1e-6
        assert later[name].value == pytest.approx(live[name].value, abs=near), name
    assert later["line"].why == "a recording holds no pings"
