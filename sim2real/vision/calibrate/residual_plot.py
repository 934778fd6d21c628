"""The plot of a calibration: the residuals of each view's points, and the fitted surface."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from sim2real.vision.calibrate.holdout_view import HoldoutCheck
from sim2real.vision.calibrate.multiview import MultiviewFit
from sim2real.vision.camera_file import Setup

SEEN, WRONG, MARKER, EDGE = "#1f6fb4", "#c0392b", "#d9822b", "0.6"
MAGNIFICATION = 60.0  # of the arrows: 1 mm is drawn as 6 cm of the table


def write_plot(file: Path, setup: Setup, fit: MultiviewFit, checked: HoldoutCheck | None) -> None:
    """Write the plot as a PNG file: a panel for each view, for the unused view if there is one, and for the surface."""
    views = fit.problem.views
    figure = Figure(figsize=(4.2 * (len(views) + 1 + (checked is not None)), 6.5), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots(1, len(views) + 1 + (checked is not None), squeeze=False)[0]
    for ax, view, off, wrong in zip(axes, views, fit.off, fit.wrong, strict=False):
        _draw_points(ax, setup, fit, view.places, off, wrong)
        ax.set_title(f"{view.name}: {_error_text(off)}", fontsize=10)
    if checked is not None:
        none = np.zeros(len(checked.off), bool)
        _draw_points(axes[-2], setup, fit, checked.view.places, checked.off, none)
        axes[-2].set_title(f"{checked.view.name}, not used: {_error_text(checked.off)}", fontsize=10)
    _draw_surface(figure, axes[-1], setup, fit)
    figure.suptitle("seen minus measured position, on the table; arrows magnified 60 times")
    figure.savefig(file, dpi=110)


def _error_text(off: np.ndarray) -> str:
    far = 1e3 * np.hypot(*off.T)
    return f"mean {far.mean():.2f}, max {far.max():.2f} mm"


def _draw_points(
    ax: Axes, setup: Setup, fit: MultiviewFit, places: np.ndarray, off: np.ndarray, wrong: np.ndarray
) -> None:
    """Draw residual arrows at places (n, 2) [m], oriented as the camera sees the table: x up, y to the left."""
    _draw_table(ax, setup, fit)
    colours = np.where(wrong, WRONG, SEEN)
    ax.scatter(places[:, 1], places[:, 0], s=9, c=colours)
    ax.quiver(
        places[:, 1], places[:, 0], off[:, 1], off[:, 0],
        color=colours, angles="xy", scale_units="xy", scale=1.0 / MAGNIFICATION, width=0.006,
    )  # fmt: skip
    for k in np.flatnonzero(wrong | (np.hypot(*off.T) > 1e-3)):
        said = f"{k + 1}: {1e3 * np.hypot(*off[k]):.1f}"
        ax.annotate(
            said,
            (places[k, 1], places[k, 0]),
            (5, 5),
            textcoords="offset points",
            fontsize=8,
            color=colours[k],
        )


def _draw_table(ax: Axes, setup: Setup, fit: MultiviewFit) -> None:
    length, width = setup.length, setup.width
    ax.plot([0, width, width, 0, 0], [0, 0, length, length, 0], color=EDGE, lw=1)
    for marker, corners in fit.geometry.markers.items():
        ax.fill(corners[:, 1], corners[:, 0], color=MARKER, alpha=0.4, lw=0)
        x, y, _ = corners.mean(axis=0)
        ax.text(y, x, str(marker), ha="center", va="center", fontsize=8)
    ax.set(xlim=(width + 0.2, -0.2), ylim=(-0.1, length + 0.1), aspect="equal", xlabel="y [m]", ylabel="x [m]")


def _draw_surface(figure: Figure, ax: Axes, setup: Setup, fit: MultiviewFit) -> None:
    _draw_table(ax, setup, fit)
    x, y = np.meshgrid(np.linspace(0, setup.length, 60), np.linspace(0, setup.width, 40), indexing="ij")
    z = fit.geometry.surface.height(np.stack([x.ravel(), y.ravel()], axis=1)).reshape(x.shape)
    lines = ax.contourf(y, x, 1e3 * z, levels=12, cmap="viridis")
    figure.colorbar(lines, ax=ax, label="height above the middle [mm]", shrink=0.6)
    ax.set_title("surface", fontsize=10)
