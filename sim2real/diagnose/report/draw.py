"""The pictures of the report: what laws fail to foretell, and laws as curves."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.binned import Binned, binned
from sim2real.diagnose.finding import Curve, Parting
from sim2real.diagnose.report.chart import AFTER, BEFORE, FAINT, INK, Chart, span
from sim2real.diagnose.report.words import number

SURE = 2.0  # standard errors that an error bar shows, and from which an arrow is coloured
CELLS = 10  # of the map, along the table
MOST_ARROWS = 0.9  # share of the arrows that are drawn in full, the longest of them a cell long
LONGEST = 2.0  # cells, at which longer ones are cut
FEWEST = 3  # pieces of a cell
SAME = 0.02  # of the noise, by which before and after may differ and be one


def curve_picture(curve: Curve, told: str) -> str:
    """A law with its band, the data in bins with errors, and a readable formula where there is one."""
    error = SURE * curve.data_error
    drawn = [curve.low, curve.high, curve.data_y - error, curve.data_y + error]
    low, high = span(*drawn, *(() if curve.formula is None else (curve.formula,)), margin=0.14)
    left, right = span(curve.x, curve.data_x, margin=0.03)
    if curve.ticks:
        left, right = -0.5, len(curve.ticks) - 0.5
    chart = Chart((left, low), (right, high), curve.x_label, curve.y_label, 620, 320, ticks=curve.ticks)
    chart.name("law with 95 % band", AFTER)
    if curve.ticks:
        chart.points(curve.x - 0.08, curve.y, 0.5 * (curve.high - curve.low), AFTER, square=True)
        chart.points(curve.data_x + 0.08, curve.data_y, error, INK)
    else:
        chart.band(curve.x, curve.low, curve.high, AFTER)
        chart.line(curve.x, curve.y, AFTER, thick=2.2)
        chart.points(curve.data_x, curve.data_y, error, INK)
    if len(curve.data_x):
        chart.name("recording", INK)
    if curve.formula is not None:
        chart.line(curve.x, curve.formula, BEFORE, dashed=True, thick=2.0)
        chart.name("formula", BEFORE)
    return chart.svg(told)


def parting_pictures(parting: Parting, label: str) -> str:
    """What laws fail to foretell, along one coordinate: a chart a component, before and after."""
    return "".join(_parting_chart(parting, label, k) for k in range(len(parting.components)))


def along(parting: Parting, label: str, component: int) -> dict[str, Binned]:
    """A component of a parting in bins along a coordinate: before and after, or one where nothing was found."""
    x, std = parting.by[label], parting.std[:, component]
    after = binned(x, parting.after[:, component], std)
    if unchanged(parting):
        return {"refitted": after}
    return {"before": binned(x, parting.before[:, component], std), "after": after}


def unchanged(parting: Parting) -> bool:
    """Whether nothing was found, so that before and after are one."""
    return bool(np.all(np.abs(parting.after - parting.before) < SAME * parting.std))


def _parting_chart(parting: Parting, label: str, component: int) -> str:
    series = along(parting, label, component)
    values = [some.y + sign * SURE * some.error for some in series.values() for sign in (-1, 1)]
    low, high = span(*values, np.zeros(1), margin=0.16)
    left, right = span(*(some.x for some in series.values()))
    name = parting.components[component]
    chart = Chart((left, low), (right, high), label, f"{name} [{parting.unit}]")
    told = []
    for which, some in series.items():
        colour = BEFORE if which == "before" else AFTER
        chart.line(some.x, some.y, colour, dashed=which == "before")
        chart.points(some.x, some.y, SURE * some.error, colour, square=which != "before")
        chart.name(which, colour)
        told.append(f"{which} up to {number(float(np.abs(some.y).max(initial=0.0)))} {parting.unit}")
    return chart.svg(f"{parting.what} {name}, not foretold, by {label}: {', '.join(told)}")


def map_pictures(parting: Parting) -> dict[str, tuple[str, float]]:
    """Mean missing vectors by place on the table, before and after, to one scale: picture, and what is a cell long."""
    both = {"before": parting.before, "after": parting.after}
    if unchanged(parting):
        both = {"refitted": parting.after}
    found = {name: arrows(parting, values) for name, values in both.items()}
    sizes = np.concatenate([np.hypot(*some[1].T) for some in found.values()])
    scale = (float(np.quantile(sizes, MOST_ARROWS)) if len(sizes) else 0.0) or 1.0
    return {name: (_map(parting, name, some, scale), scale) for name, some in found.items()}


def _map(parting: Parting, name: str, found, scale: float) -> str:
    assert parting.size is not None
    length, width = parting.size
    edge = 0.05 * width
    chart = Chart((-edge, -edge), (length + edge, width + edge), "x [m]", "y [m]", 460, square=True)
    chart.line([0, length, length, 0, 0], [0, 0, width, width, 0], INK, thick=1.0)
    for place, vector, sure in zip(*found, strict=True):
        colour = (BEFORE if name == "before" else AFTER) if sure else FAINT
        chart.arrow(place, _within(place, vector / scale * length / CELLS, parting.size), colour)
    most = f"most below {number(scale)} {parting.unit}"
    return chart.svg(f"map of the table, {name}: mean {parting.what} by place, {most}")


def _within(place: np.ndarray, arrow: np.ndarray, size: tuple[float, float]) -> np.ndarray:
    """An arrow, cut where it would leave the table or be longer than LONGEST cells."""
    room = np.where(arrow > 0.0, np.array(size) - place, place)
    share = room / np.maximum(np.abs(arrow), 1e-12)
    longest = LONGEST * size[0] / CELLS / max(float(np.hypot(*arrow)), 1e-12)
    return arrow * float(np.clip(min(longest, *share), 0.0, 1.0))


def arrows(parting: Parting, values: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean vectors of `values` (n, c) by cell of the table: places (k, 2), vectors (k, 2), whether more than noise."""
    assert parting.place is not None and parting.axis is not None and parting.size is not None
    cell = parting.size[0] / CELLS
    left = np.stack([-parting.axis[:, 1], parting.axis[:, 0]], axis=1)
    vectors = values[:, :1] * parting.axis + values[:, 1:2] * left
    where = np.floor(parting.place / cell).astype(int)
    found = []
    for here in np.unique(where, axis=0):
        use = (where == here).all(axis=1)
        if use.sum() >= FEWEST:
            weight = 1.0 / (parting.std[use, :2] ** 2).mean(axis=1)
            weight /= weight.sum()
            mean = weight @ vectors[use]
            error = np.sqrt(weight**2 @ ((vectors[use] - mean) ** 2).sum(axis=1))
            found.append((weight @ parting.place[use], mean, np.hypot(*mean) > SURE * error))
    if not found:
        return np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, bool)
    place, mean, sure = (np.array(column) for column in zip(*found, strict=True))
    return place, mean, sure
