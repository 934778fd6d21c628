"""Pictures: everything is where it should be, and nothing else changes."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import parameters
from puckpilot_env.game import state
from puckpilot_env.rendering import canvas, drawing, rink
from puckpilot_env.variants import all_variants, find_variant

P = parameters.make_records(1)[0]
MATCH = find_variant("match-v0").rules()[0]
DRILL = find_variant("defence-v0").rules()[0]


def make_table(puck=(1.2, 0.3), mallets=((0.3, 0.6), (1.7, 0.45))) -> np.void:
    table = np.zeros(1, state.TABLE)[0]
    table["puck"]["x"], table["puck"]["y"] = puck
    for mallet, place in zip(table["mallets"], mallets, strict=True):
        for axis, position in zip("xy", place, strict=True):
            mallet[axis]["rest"] = position
            mallet[axis]["slow"], mallet[axis]["fast"] = 0.01, -0.01  # a place is the sum of its modes
    return table


def centroid(picture, colour, near, reach) -> tuple[float, float]:
    """Middle (x, y) in pixels of a colour's pixels within `reach` of a place."""
    rows, columns = np.nonzero((picture == np.array(colour)).all(axis=2))
    x, y = columns + 0.5, rows + 0.5
    close = np.hypot(x - near[0], y - near[1]) < reach
    assert close.sum() > 10
    return x[close].mean(), y[close].mean()


@pytest.mark.parametrize(
    ("values", "scale", "shape"),
    [({}, 280.0, (360, 640)), ({}, 140.0, (180, 320)), ({"length": 1.2, "width": 0.8}, 280.0, (304, 416))],
)
def test_picture_has_the_shape_of_its_table(values, scale, shape):
    p = parameters.make_records(1, values)[0]
    picture = drawing.draw(make_table((0.5, 0.3), ((0.3, 0.4), (0.9, 0.4))), p, scale=scale)
    assert picture.shape == (*shape, 3) and picture.dtype == np.uint8


@pytest.mark.parametrize("puck", [(1.2, 0.3), (0.7013, 0.8027), (1.0, 0.5), (0.0, 0.5)])
def test_puck_is_where_the_state_says(puck):
    expected = 40.0 + 280.0 * puck[0], 56.0 + 280.0 * (1.0 - puck[1])
    found = centroid(drawing.draw(make_table(puck), P), rink.PUCK, expected, 20.0)
    assert found == pytest.approx(expected, abs=0.3)


@pytest.mark.parametrize("player", [0, 1])
def test_mallets_and_beams_are_where_the_state_says(player):
    mallet = ((0.3, 0.6), (1.7, 0.45))[player]
    expected = 40.0 + 280.0 * mallet[0], 56.0 + 280.0 * (1.0 - mallet[1])
    picture = drawing.draw(make_table(), P)
    rim = rink.mix(rink.PLAYERS[player], rink.INK, 0.12)
    assert centroid(picture, rim, expected, 15.0) == pytest.approx(expected, abs=0.3)
    row = picture[300, 45:595].astype(int)  # crosses both beams below the mallets, clear of puck and goal areas
    other = drawing.draw(make_table(mallets=((0.5, 0.6), (1.5, 0.45))), P)[300, 45:595].astype(int)
    columns = 45.5 + np.nonzero(np.abs(row - other).max(axis=1))[0]
    beam = columns[np.abs(columns - expected[0]) < 15]
    assert (beam.min() + beam.max()) / 2 == pytest.approx(expected[0], abs=0.6)
    assert len(beam) == pytest.approx(P["beam_width"] * 280.0, abs=2)


def test_moving_the_puck_changes_its_surroundings_alone():
    here, there = (1.2, 0.3), (0.8, 0.75)
    changed = (drawing.draw(make_table(here), P) != drawing.draw(make_table(there), P)).any(axis=2)
    rows, columns = np.nonzero(changed)
    place = rink.layout(P)
    away = [np.hypot(columns + 0.5 - x, rows + 0.5 - y) for x, y in (place.pixel(*here), place.pixel(*there))]
    radius = P["puck_radius"] * rink.SCALE
    assert np.minimum(*away).max() < 1.6 * radius
    assert min((a < radius).sum() for a in away) > 0.95 * np.pi * radius**2


def test_drawing_leaves_nothing_behind():
    first = drawing.draw(make_table(), P)
    drawing.draw(make_table((0.4, 0.8), ((0.1, 0.1), (1.2, 0.9))), P, trail=[(0.2, 0.2), (0.4, 0.8)])
    np.testing.assert_array_equal(drawing.draw(make_table(), P), first)


def test_trail_darkens_towards_the_puck():
    trail = np.linspace((0.6, 0.3), (0.9, 0.3), 30)
    ice, lined = (drawing.draw(make_table(), P, trail=points).astype(int) for points in (None, trail))
    darker = (ice - lined).sum(axis=2)[252]
    assert darker[40 + 280 : 300].sum() == 0
    assert darker[220] < darker[250] < darker[285]
    rows = np.nonzero((ice != lined).any(axis=2))[0]
    assert rows.min() >= 244 and rows.max() <= 260


@pytest.mark.parametrize("trail", [np.zeros((0, 2)), [(1.0, 0.5)], [(1.0, 0.5)] * 3, [(-9.0, 0.5), (-8.0, 0.5)]])
def test_odd_trails_are_drawn_without_error(trail):
    assert drawing.draw(make_table(), P, trail=trail).shape == (360, 640, 3)


def test_score_is_shown_in_matches_alone():
    table, later = make_table(), make_table()
    later["score"] = 3, 1
    changed = (drawing.draw(table, P, rules=MATCH) != drawing.draw(later, P, rules=MATCH)).any(axis=(1, 2))
    assert changed[:30].any() and not changed[30:].any()
    np.testing.assert_array_equal(drawing.draw(table, P, rules=DRILL), drawing.draw(later, P, rules=DRILL))


def test_header_says_who_defends_and_cuts_long_names():
    table = make_table()
    attacking = drawing.draw(table, P)
    table["defending"][1] = 1
    changed = np.nonzero((attacking != drawing.draw(table, P)).any(axis=(0, 2)))[0]
    assert len(changed) and changed.min() > 320
    long = drawing.draw(table, P, names=("a name that is far too long for the room " * 3, "b"))
    short = drawing.draw(table, P, names=("", "b"))
    changed = np.nonzero((long != short).any(axis=(0, 2)))[0]
    assert changed.max() < 290


@pytest.mark.parametrize(
    ("seconds", "words"), [(180.0, "3:00"), (179.9, "3:00"), (65.0, "1:05"), (0.0, "0:00"), (-1, "0:00")]
)
def test_clock(seconds, words):
    assert drawing.clock(seconds) == words


@pytest.mark.parametrize("scale", [0.0, -1.0, 1e9, float("nan")])
def test_impossible_scale_is_refused(scale):
    with pytest.raises(ValueError, match="pixels a metre"):
        drawing.draw(make_table(), P, scale=scale)


def test_shapes_are_exact_to_a_fraction_of_a_pixel():
    picture = np.zeros((20, 20, 3), np.uint8)
    canvas.disc(picture, 10.3, 9.6, 5.0, (200, 200, 200))
    weight = picture[..., 0] / 200.0
    assert weight.sum() == pytest.approx(np.pi * 25.0, rel=0.01)
    assert (weight * (np.arange(20) + 0.5)).sum() / weight.sum() == pytest.approx(10.3, abs=0.02)
    picture[:] = 0
    canvas.box(picture, 2.25, -5.0, 4.5, 3.5, (200, 200, 200))
    assert picture[..., 0].sum() / 200.0 == pytest.approx(2.25 * 3.5)
    canvas.text(picture, -5.0, 19.0, "cut off", 12, (9, 9, 9))


@pytest.mark.parametrize("variant", all_variants().values(), ids=lambda v: v.name)
def test_start_of_a_variant(variant):
    picture = drawing.draw_start(variant, seed=5)
    assert picture.shape == (360, 640, 3)
    np.testing.assert_array_equal(picture, drawing.draw_start(variant, seed=5))
    assert (picture != drawing.draw_start(variant, seed=6)).any()
