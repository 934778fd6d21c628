"""What a camera shows of the tables of a batch: how old it is, and what a held frame is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env import Tables, find_variant
from puckpilot_env.adapters.infos import drawn_info
from puckpilot_env.batch.trace import trace


@pytest.mark.parametrize("frame_rate", [10.0, 120.0, 300.0])
@pytest.mark.parametrize("period", [1 / 120, 0.1, 0.55, 1.0])
@pytest.mark.parametrize("variant", ["match-sensors-v0", "match-randomized-v0"])
def test_the_newest_frame_shows_the_table_as_it_was(variant, period, frame_rate):
    """Without noise, it is where a puck that nobody touches was `age` ago, however many frames a step has."""
    clean = ("camera_noise", "beam_noise", "camera_error", "dropped_frames", "held_frames", "beam_width")
    given = {"frame_rate": frame_rate, "camera_latency": 0.06, "mallet_radius": 0.02, **dict.fromkeys(clean, 0.0)}
    known = find_variant(variant)
    tables = Tables(replace(known, draws=()), 8, seed=4, period=period, parameters=given)
    names = [column.name for column in tables.observation_columns]
    seen = names.index("puck_0_x" if variant == "match-sensors-v0" else "puck_x")
    stay = np.concatenate([tables.observations[:, :, :2], np.full((8, 2, 2), 0.3, np.float32)], axis=2)
    for _ in range(max(1, round(1.0 / period))):
        tables.step(stay)
    now, phase = tables.states["time"], tables.states["frame_phase"]
    exposed = (np.floor((now - 0.06) * frame_rate - phase + 1e-9) + phase) / frame_rate
    for i in range(8):
        past = Tables(replace(known, draws=()), 8, seed=4, period=1 / 120, parameters=given)
        for _ in range(int(exposed[i] * 120)):
            past.step(stay)
        (moment,), _ = trace(past, i, stay[i], [exposed[i] - past.states["time"][i]])
        expected = [moment["puck"]["x"], moment["puck"]["y"]]
        np.testing.assert_allclose(tables.observations[i, 0, seen : seen + 2], expected, atol=1e-5)


def test_the_told_camera_delay_is_that_of_the_first_observation():
    """A puck that comes straight is seen `camera_delay` times its velocity before the place where it is."""
    clean = dict.fromkeys(
        ("camera_noise", "beam_noise", "camera_error", "beam_width", "dropped_frames", "held_frames"), 0.0
    )
    known = find_variant("match-randomized-v0")
    draws = tuple(draw for draw in known.draws if draw.parameter not in (*clean, "length", "width"))
    for latency in (0.0, 0.0134, 0.06):
        given = {**clean, "camera_latency": latency}
        tables = Tables(replace(known, draws=draws), 200, seed=2, parameters=given)
        names = [column.name for column in tables.observation_columns]
        puck = tables.states["puck"]
        seen = tables.observations[:, 0, names.index("puck_x")]
        printed = drawn_info(tables, np.zeros(200, int))["camera_delay"]
        np.testing.assert_allclose((puck["x"] - seen) / puck["vx"], printed, atol=1e-5)
        assert printed.min() >= latency - 1e-9 and printed.max() <= latency + 1 / 120


def test_a_held_frame_repeats_the_one_before():
    """So a velocity, a difference over two frames, is of half the way where the newer one is held, of 3/2 where the
    older one is; twice in a row is rarer."""
    clean = ("camera_noise", "beam_noise", "camera_error", "dropped_frames", "beam_width", "friction", "drag")
    values = {**dict.fromkeys(clean, 0.0), "held_frames": 0.05}
    tables = Tables(replace(find_variant("defence-randomized-v0"), draws=()), 2000, seed=1, parameters=values)
    column = [column.name for column in tables.observation_columns].index("puck_vx")
    stay = np.concatenate([tables.observations[:, :, :2], np.full((2000, 2, 2), 0.3, np.float32)], axis=2)
    before = tables.states["puck"]["vx"].copy()
    for _ in range(2):
        tables.step(stay)
    free = (tables.states["puck"]["vx"] == before) & (tables.states["steps"] == 2)
    ratios = (tables.observations[:, 0, column] / before)[free].round(3)
    assert len(ratios) > 300
    assert ((ratios == 0.5) | (ratios == 1.5)).mean() == pytest.approx(0.09, abs=0.04)
    assert (ratios > 2.0).mean() < 0.005
