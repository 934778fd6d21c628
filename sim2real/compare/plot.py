"""The picture of a comparison: one PNG with four panels."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.colors import LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

from sim2real.compare.contacts import ContactError
from sim2real.compare.predict import Comparison
from sim2real.compare.tuned import COMPARISON
from sim2real.segmentation.segments import Segments

RECORDED, TANGENT, SIMULATOR, EVENT = "#1f6fb4", "#d9822b", "#222222", "#c0392b"
RATIOS = (-0.2, 1.4)  # range of the axis
MEDIAN_OF_RMS = math.sqrt(math.log(2))  # median by rms of a distance in the plane under white noise


def draw(file: Path, title: str, segments: Segments, found: Comparison, values: dict[str, float]) -> None:
    """Write the picture `file` (PNG). `title`: the recording's name; `values`: the simulator's parameters by name."""
    figure = Figure(figsize=(14, 9), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(f"{title}: recording and simulator")
    (table, growth), (walls, mallets) = figure.subplots(2, 2)
    _draw_table(figure, table, segments, found, values)
    _draw_growth(growth, found)
    _draw_walls(walls, found.walls, values["wall_restitution"])
    _draw_mallets(mallets, found.mallets)
    figure.savefig(file, dpi=110)


def _draw_table(figure: Figure, ax: Axes, segments: Segments, found: Comparison, values: dict[str, float]) -> None:
    ax.set(title="Glides: distance from prediction", xlabel="x [m]", ylabel="y [m]", aspect="equal")
    length, width = values["length"], values["width"]
    ax.plot([0, length, length, 0, 0], [0, 0, width, width, 0], color="0.6", lw=1)
    off = [np.hypot(*g.error.T) for g in found.glides]
    if off:
        steps, colours = [], []
        for g, distance in zip(found.glides, off, strict=True):
            place = np.stack([g.x, g.y], axis=1)
            steps.append(np.stack([place[:-1], place[1:]], axis=1))
            colours.append(1e3 * distance[1:])
        lines = LineCollection(list(np.concatenate(steps)), cmap="viridis", norm=LogNorm(0.1, 100), lw=0.9)
        lines.set_array(np.concatenate(colours).clip(0.1, 100))
        ax.add_collection(lines)
        figure.colorbar(lines, ax=ax, label="observed − predicted [mm]", shrink=0.75)
    unexplained = [(h.x, h.y) for h in segments.of_kind("unexplained")]
    if unexplained:
        label = f"{len(unexplained)} unexplained events"
        ax.plot(*np.array(unexplained).T, "x", color=EVENT, ms=4, mew=0.8, label=label)
        ax.legend(loc="upper right", fontsize=8)


def _draw_growth(ax: Axes, found: Comparison) -> None:
    ax.set(title="Glides: error beyond the fitted start", xlabel="time since the fit [s]", ylabel="distance [mm]")
    if not found.glides:
        _write_instead(ax, "no glide to compare")
        return
    t = np.concatenate([g.t[g.fitted :] - g.t[g.fitted - 1] for g in found.glides])
    off = np.concatenate([1e3 * np.hypot(*g.error[g.fitted :].T) for g in found.glides])
    noise = np.concatenate([1e3 * np.hypot(*g.std[g.fitted :].T) for g in found.glides])
    for g in found.glides:
        ahead = slice(g.fitted, None)
        ax.plot(g.t[ahead] - g.t[g.fitted - 1], 1e3 * np.hypot(*g.error[ahead].T), color="0.8", lw=0.3)
    edges = np.quantile(t, np.linspace(0, 1, 16))
    which = np.clip(np.searchsorted(edges, t) - 1, 0, 14)
    middle = [np.median(t[which == k]) for k in range(15)]
    recorded = [np.median(off[which == k]) for k in range(15)]
    alone = [MEDIAN_OF_RMS * np.median(noise[which == k]) for k in range(15)]
    ax.plot(middle, recorded, color=RECORDED, lw=2, label="median observed")
    ax.plot(middle, alone, color=SIMULATOR, lw=1.5, ls="--", label="median of noise alone")
    ax.set_yscale("log")
    ax.set_ylim(bottom=0.3 * float(np.nanmin([*alone, *recorded])))
    ax.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    ax.yaxis.set_minor_formatter(NullFormatter())
    ax.legend(fontsize=8)


def _draw_walls(ax: Axes, contacts: tuple[ContactError, ...], restitution: float) -> None:
    ax.set(title="Wall contacts: ratio of speed kept", xlabel="speed of the component before [m/s]", ylabel="ratio")
    if not contacts:
        _write_instead(ax, "no wall contact to compare")
        return
    before, after = np.array([h.before for h in contacts]), np.array([h.after for h in contacts])
    for axis, sign, colour, name in ((0, -1, RECORDED, "normal"), (1, 1, TANGENT, "tangential")):
        use = np.abs(before[:, axis]) > COMPARISON.clear_speed
        ratio = sign * after[use, axis] / before[use, axis]
        std = np.array([h.std[axis] for h in contacts])[use] / np.abs(before[use, axis])
        ax.errorbar(np.abs(before[use, axis]), ratio, yerr=std, fmt=".", color=colour, ms=5, lw=0.5)
        beyond = int(((ratio < RATIOS[0]) | (ratio > RATIOS[1])).sum())
        ax.plot([], [], ".", color=colour, label=f"{name}, {beyond} beyond the frame" if beyond else name)
    ax.axhline(restitution, color=SIMULATOR, lw=1.2, ls="--", label="simulator")
    ax.set_ylim(*RATIOS)
    ax.set_xlim(left=0)
    ax.legend(fontsize=8)


def _draw_mallets(ax: Axes, contacts: tuple[ContactError, ...]) -> None:
    ax.set(title="Mallet contacts: speed away from the mallet", xlabel="predicted [m/s]", ylabel="observed [m/s]")
    if not contacts:
        _write_instead(ax, "no mallet contact to compare")
        return
    predicted, after = np.array([h.predicted[0] for h in contacts]), np.array([h.after[0] for h in contacts])
    for who, colour in (("robot", RECORDED), ("opponent", TANGENT)):
        use = np.array([h.contact.where == who for h in contacts])
        if use.any():
            ax.plot(predicted[use], after[use], ".", color=colour, label=who)
    top = 1.05 * max(predicted.max(), after.max(), 0.1)
    ax.plot([0, top], [0, top], color=SIMULATOR, lw=1.2, ls="--", label="simulator")
    ax.legend(fontsize=8)


def _write_instead(ax: Axes, words: str) -> None:
    ax.set_axis_off()
    ax.text(0.5, 0.5, words, ha="center", va="center", transform=ax.transAxes, color="0.4")
