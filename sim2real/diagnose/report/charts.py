"""The figures of the report: laws as curves, residuals by coordinate and by place, rms residuals as bars.

Each `draw_*` fills matplotlib axes; the function before it returns the inline SVG.
"""

from __future__ import annotations

from functools import partial
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from sim2real.diagnose.report.binned_residuals import BEFORE, STANDARD_ERRORS, MapArrows, along
from sim2real.diagnose.report.inline_svg import BOTTOM, FAINT, INK, LEFT, RIGHT, inline_svg
from sim2real.diagnose.report.plain_words import number
from sim2real.diagnose.result.result import Curve, Mismatch

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ORANGE, BLUE, GREY = "#D55E00", "#0072B2", "#767676"  # Okabe and Ito: distinct to the colour-blind
LETTER = 6.6  # mean width of a letter [points]
CURVE, PANEL = (400.0, 250.0), (360.0, 185.0)  # width and height [points]
MAP_WIDTH, BAR_WIDTH, BAR_HEIGHT = 380.0, 380.0, 24.0
MAP_EDGE = 0.05  # around the table, as a share of its width


def curve_picture(curve: Curve, description: str) -> str:
    """Return a law with its 95 % band, the binned data with errors, and the readable formula if there is one."""
    return inline_svg(description, *CURVE, partial(draw_curve, curve=curve))


def draw_curve(axes: Axes, curve: Curve) -> None:
    """Draw the law as a line with its band, or as squares with error bars if x is categorical or a single value."""
    error, discrete = STANDARD_ERRORS * curve.data_error, bool(curve.ticks) or len(curve.x) == 1
    shift = 0.08 if curve.ticks else 0.0
    axes.margins(x=0.03, y=0.08)
    if discrete:
        half = 0.5 * (curve.high - curve.low)
        _points(axes, curve.x - shift, curve.y, half, BLUE, "s", "law with 95 % interval")
    else:
        axes.fill_between(curve.x, curve.low, curve.high, color=BLUE, alpha=0.25, linewidth=0.0)
        axes.plot(curve.x, curve.y, color=BLUE, linewidth=2.0, label="law with 95 % band")
    if len(curve.data_x):
        _points(axes, curve.data_x + shift, curve.data_y, error, INK, "o", "recording")
    if curve.formula is not None:
        axes.plot(curve.x, curve.formula, color=ORANGE, linewidth=2.0, linestyle="--", label="formula")
    if curve.ticks:
        axes.set_xticks(range(len(curve.ticks)), curve.ticks)
        axes.set_xlim(-0.5, len(curve.ticks) - 0.5)
    _label(axes, curve.x_label, curve.y_label, CURVE[1], counts=bool(curve.ticks))


def residual_pictures(mismatch: Mismatch, coordinate: str) -> list[str]:
    """Return the residuals along one coordinate, before and after, one figure for each component."""
    return [_residual_picture(mismatch, coordinate, k) for k in range(len(mismatch.components))]


def _residual_picture(mismatch: Mismatch, coordinate: str, component: int) -> str:
    sizes = [
        f"{name} up to {number(float(np.abs(some.y).max(initial=0.0)))} {mismatch.unit}"
        for name, some in along(mismatch, coordinate, component).items()
    ]
    name = mismatch.components[component]
    description = f"{mismatch.what} {name}, not predicted, by {coordinate}: {', '.join(sizes)}"
    return inline_svg(
        description, *PANEL, partial(draw_residuals, mismatch=mismatch, coordinate=coordinate, component=component)
    )


def draw_residuals(axes: Axes, mismatch: Mismatch, coordinate: str, component: int) -> None:
    """Draw binned means of one component along one coordinate, with ±2 standard errors, and zero."""
    axes.margins(x=0.06, y=0.12)
    axes.axhline(0.0, color=FAINT, linewidth=1.0)
    for name, some in along(mismatch, coordinate, component).items():
        first = name == BEFORE
        colour = ORANGE if first else BLUE
        axes.plot(some.x, some.y, color=colour, linewidth=1.6, linestyle="--" if first else "-")
        _points(axes, some.x, some.y, STANDARD_ERRORS * some.error, colour, "o" if first else "s", name)
    _label(axes, coordinate, f"{mismatch.components[component]} [{mismatch.unit}]", PANEL[1])


def map_picture(mismatch: Mismatch, name: str, arrows: MapArrows) -> str:
    """Return mean residual vectors by place on the table; `name`: of the law."""
    assert mismatch.size is not None
    length, width = mismatch.size
    edge = 2.0 * MAP_EDGE * width
    height = (MAP_WIDTH - LEFT - RIGHT) * (width + edge) / (length + edge) + RIGHT + BOTTOM
    most = f"most below {number(arrows.scale)} {mismatch.unit}"
    description = f"map of the table, {name}: mean {mismatch.what} by place, {most}"
    colour = ORANGE if name == BEFORE else BLUE
    draw = partial(draw_map, arrows=arrows, size=mismatch.size, colour=colour)
    return inline_svg(description, MAP_WIDTH, height, draw, (LEFT, RIGHT, BOTTOM))


def draw_map(axes: Axes, arrows: MapArrows, size: tuple[float, float], colour: str) -> None:
    """Draw the table's outline and an arrow for each cell, grey if it is not significant; equal axis scales."""
    length, width = size
    edge = MAP_EDGE * width
    axes.plot([0, length, length, 0, 0], [0, 0, width, width, 0], color=INK, linewidth=1.0)
    if len(arrows.places):
        colours = [colour if significant else FAINT for significant in arrows.significant]
        axes.quiver(*arrows.places.T, *arrows.vectors.T, color=colours, angles="xy", scale_units="xy", scale=1.0,
                    units="dots", width=1.6, headwidth=4.0, headlength=4.5, headaxislength=4.0)  # fmt: skip
    axes.set(xlim=(-edge, length + edge), ylim=(-edge, width + edge), aspect="equal")
    _label(axes, "x [m]", "y [m]", MAP_WIDTH)


def bars_picture(title: str, sizes: dict[str, float]) -> str:
    """Return rms residuals [m] by name as horizontal bars [mm]; the last is the noise alone."""
    description = f"{title}: {', '.join(f'{name} {number(1e3 * size)} mm' for name, size in sizes.items())}"
    left = 12.0 + LETTER * max(map(len, sizes))
    return inline_svg(
        description, BAR_WIDTH, BAR_HEIGHT * len(sizes), partial(draw_bars, sizes=sizes), (left, 0.0, 0.0)
    )


def draw_bars(axes: Axes, sizes: dict[str, float]) -> None:
    """Draw a bar for each size [m], with its value in mm at the end."""
    colours = [*(ORANGE, BLUE)[: len(sizes) - 1], GREY]
    bars = axes.barh(range(len(sizes)), [1e3 * size for size in sizes.values()], color=colours, height=0.7)
    axes.bar_label(bars, [f"{number(1e3 * size)} mm" for size in sizes.values()], padding=4)
    axes.set_yticks(range(len(sizes)), list(sizes))
    axes.set(ylim=(len(sizes) - 0.5, -0.5), xlim=(0.0, 1.5e3 * max(sizes.values()) or 1.0), xticks=[])
    axes.tick_params(length=0)
    axes.grid(False)
    axes.spines[["left", "bottom"]].set_visible(False)


def _points(axes: Axes, x: np.ndarray, y: np.ndarray, error: np.ndarray, colour: str, marker: str, name: str) -> None:
    axes.errorbar(x, y, error, fmt=marker, color=colour, markersize=5.0, elinewidth=1.1, label=name)


def _label(axes: Axes, x: str, y: str, height: float, counts: bool = False) -> None:
    """Set labels and round ticks; the y label is wrapped if it is too long for the `height`."""
    from matplotlib.ticker import FuncFormatter, MaxNLocator
    from matplotlib.transforms import blended_transform_factory

    short = FuncFormatter(lambda value, _: f"{round(value, 12):g}")
    for axis, most in ((axes.xaxis, 6), (axes.yaxis, 5)):
        if not (counts and axis is axes.xaxis):
            axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]))
            axis.set_major_formatter(short)
    axes.set_xlabel(x)
    room = height - BOTTOM
    axes.set_ylabel(fill(y, int(room / LETTER), break_long_words=False) if LETTER * len(y) > room else y, va="top")
    across = blended_transform_factory(axes.figure.transFigure, axes.transAxes)
    axes.yaxis.set_label_coords(0.005, 0.5, transform=across)
