"""Charts: the contents of the matplotlib axes and the resulting SVG."""

import re
import xml.etree.ElementTree as ET
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.quiver import Quiver

from sim2real.diagnose.report.binned_residuals import along, map_arrows
from sim2real.diagnose.report.charts import bars_picture, curve_picture, draw_bars, draw_curve, draw_map, draw_residuals
from sim2real.diagnose.report.inline_svg import inline_svg
from tests.sim2real.diagnose.report.samples import CURVE, ERROR, mismatch_sample

SIZE = (2.0, 1.0)


def _axes() -> Axes:
    return Figure(figsize=(4.0, 3.0)).add_subplot()


def test_a_figure_is_well_formed_and_has_a_description():
    def draw(axes: Axes) -> None:
        axes.plot([0.0, 1.0], [-1.0, 1.0], "o--", label="law")
        axes.set_xlabel("a < b, $1")

    svg = inline_svg('tells "all" & more', 300.0, 200.0, draw)
    root = ET.fromstring(svg.replace("xlink:", ""))
    assert root.attrib == {"role": "img", "aria-label": 'tells "all" & more', "viewBox": "0 0 300 200"}
    assert {"a < b, $1", "law"} <= {each.text for each in root.iter("text")}
    assert svg == inline_svg('tells "all" & more', 300.0, 200.0, draw)
    used = set(re.findall(r'href="#([^"]*)"', svg))
    assert used and used == set(re.findall(r' id="([^"]*)"', svg))


def test_pictures_of_the_same_data_share_no_ids():
    first, second = (set(re.findall(r' id="([^"]*)"', curve_picture(CURVE, name))) for name in ("a", "b"))
    assert first and not first & second


def test_an_error_bar_is_two_standard_errors_each_way():
    axes = _axes()
    draw_curve(axes, CURVE)
    bars = next(each for each in axes.collections if isinstance(each, LineCollection)).get_segments()
    assert [bar[1, 1] - bar[0, 1] for bar in bars] == pytest.approx(4.0 * ERROR)


@pytest.mark.parametrize("curve", [CURVE, replace(CURVE, formula=CURVE.y + 0.5), replace(CURVE, y=CURVE.y + 9.0)])
def test_nothing_of_a_curve_is_outside_the_axes(curve):
    axes = _axes()
    draw_curve(axes, curve)
    low, high = axes.get_ylim()
    for values in (curve.low, curve.high, curve.data_y - 2.0 * ERROR, curve.data_y + 2.0 * ERROR):
        assert low < values.min() and values.max() < high
    assert axes.get_xlim()[0] < -180.0 and axes.get_xlim()[1] > 180.0


def test_a_categorical_axis_has_its_labels():
    axes = _axes()
    three = {name: getattr(CURVE, name)[:3] for name in ("y", "low", "high", "data_y", "data_error")}
    draw_curve(axes, replace(CURVE, x=np.arange(3.0), data_x=np.arange(3.0), ticks=("east", "north", "west"), **three))
    assert [label.get_text() for label in axes.get_xticklabels()] == ["east", "north", "west"]
    assert axes.get_xlim() == (-0.5, 2.5)


def test_residuals_are_drawn_where_their_bins_are():
    axes, mismatch = _axes(), mismatch_sample(400)
    draw_residuals(axes, mismatch, "speed [m/s]", 0)
    binned = along(mismatch, "speed [m/s]", 0)
    lines = {
        line.get_linestyle(): line
        for line in axes.lines
        if len(np.asarray(line.get_xydata())) == len(binned["before"].x)
    }
    for style, name in (("--", "before"), ("-", "after")):
        assert np.array(lines[style].get_xydata()) == pytest.approx(np.stack([binned[name].x, binned[name].y], axis=1))
    low, high = axes.get_ylim()
    assert low < 0.0 < high
    assert axes.get_ylabel() == "along [m/s²]"


def test_maps_have_one_scale_and_no_arrow_leaves_the_table():
    mismatch = mismatch_sample(400)
    mismatch.before[:3] = 5.0  # outliers
    maps = map_arrows(mismatch)
    assert len({arrows.scale for arrows in maps.values()}) == 1
    axes = _axes()
    draw_map(axes, maps["before"], SIZE, "red")
    drawn = next(each for each in axes.collections if isinstance(each, Quiver))
    tips = np.array(drawn.get_offsets()) + np.stack([drawn.U, drawn.V], axis=1)
    assert len(tips) == len(maps["before"].places) > 10
    assert (tips >= -1e-9).all() and (tips <= np.array(SIZE) + 1e-9).all()
    assert axes.get_aspect() == 1.0


def test_bars_are_as_long_as_their_numbers():
    axes = _axes()
    sizes = {"refitted baseline": 0.004, "with the law": 0.001, "noise alone": 0.0009}
    draw_bars(axes, sizes)
    assert [bar.get_width() for bar in axes.patches if isinstance(bar, Rectangle)] == pytest.approx([4.0, 1.0, 0.9])
    assert "with the law 1 mm, noise alone 0.9 mm" in bars_picture("Residuals", sizes)
    draw_bars(_axes(), dict.fromkeys(sizes, 0.0))
