"""Charts by the numbers in their SVG."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from sim2real.diagnose.report.chart import BOTTOM, LEFT, RIGHT, TOP, Chart, nice, span


@pytest.mark.parametrize(
    "low, high, count, ticks",
    [
        (0.0, 1.0, 5, [0.0, 0.2, 0.4, 0.6, 0.8, 1.0]),
        (-0.03, 0.021, 4, [-0.02, 0.0, 0.02]),
        (7.0, 7.4, 2, [7.0, 7.2, 7.4]),
    ],
)
def test_ticks_are_round(low, high, count, ticks):
    assert nice(low, high, count) == pytest.approx(ticks)


def test_a_constant_has_a_range():
    low, high = span(np.full(3, 0.8))
    assert low < 0.8 < high
    assert span(np.zeros(0)) == (0.0, 1.0)


def test_data_lie_where_they_belong():
    chart = Chart((0.0, 0.0), (2.0, 4.0), "x", "y", 300, 200)
    corners = chart.at([0.0, 2.0], [0.0, 4.0])
    assert corners[0] == pytest.approx([LEFT, 200 - BOTTOM])
    assert corners[1] == pytest.approx([300 - RIGHT, TOP])


def test_a_square_chart_has_one_unit_for_both_axes():
    chart = Chart((0.0, 0.0), (2.0, 1.0), "x", "y", 400, square=True)
    a, b, c = chart.at([0.0, 1.0, 0.0], [0.0, 0.0, 1.0])
    assert np.hypot(*(b - a)) == pytest.approx(np.hypot(*(c - a)), rel=0.01)


def test_a_picture_is_well_formed_and_tells_what_it_shows():
    chart = Chart((0.0, -1.0), (1.0, 1.0), "a < b", "y")
    chart.line([0.0, 1.0], [-1.0, 1.0], "red", dashed=True)
    chart.band([0.0, 1.0], [-1.0, 0.0], [0.0, 1.0], "red")
    chart.points(np.array([0.5]), np.array([0.0]), np.array([0.5]), "blue")
    chart.arrow(np.array([0.5, 0.0]), np.array([0.2, 0.2]), "blue")
    chart.name("law", "red")
    root = ET.fromstring(chart.svg('tells "all" & more'))
    assert root.get("aria-label") == 'tells "all" & more'
    assert "a < b" in [each.text for each in root.iter("text")]


def test_an_error_bar_is_as_long_as_the_error():
    chart = Chart((0.0, -1.0), (1.0, 1.0), "x", "y")
    chart.points(np.array([0.5]), np.array([0.0]), np.array([0.5]), "blue")
    found = re.search(r'd="M([\d.]+) ([\d.]+)V([\d.]+)"', "".join(chart.parts))
    assert found is not None
    low, high = float(found[2]), float(found[3])
    assert low - high == pytest.approx(0.5 * (chart.height - TOP - BOTTOM), abs=0.2)  # 1 of 2 units
