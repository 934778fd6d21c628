"""Matplotlib axes as self-contained inline SVG; the same data give the same bytes."""

from __future__ import annotations

import re
from collections.abc import Callable
from html import escape
from io import StringIO
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from matplotlib.axes import Axes

INK, FAINT, GRID = "#1a1a1a", "#b0b0b0", "#e5e5e5"
POINTS_PER_INCH = 72.0  # the unit of matplotlib's SVG
LEFT, TOP, BOTTOM, RIGHT = 74.0, 20.0, 36.0, 10.0  # margins of the axes [points]
STYLE: dict[Any, Any] = {
    "svg.fonttype": "none",
    "text.parse_math": False,
    "font.family": "DejaVu Sans",
    "font.size": 11.0,
    "xtick.labelsize": 10.0,
    "ytick.labelsize": 10.0,
    "text.color": INK,
    "axes.labelcolor": INK,
    "axes.edgecolor": INK,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "legend.frameon": False,
    "legend.handlelength": 1.2,
    "legend.columnspacing": 1.2,
}
OUTSIDE = r"<metadata>.*?</metadata>|<style.*?</style>|<clipPath.*?</clipPath>|<!--.*?-->| clip-path=\"[^\"]*\""
FONTS = "'DejaVu Sans', Verdana, system-ui, sans-serif"


def inline_svg(
    description: str,
    width: float,
    height: float,
    draw: Callable[[Axes], None],
    margins: tuple[float, float, float] = (LEFT, TOP, BOTTOM),
) -> str:
    """Return an <svg> element of `width` × `height` [points] that scales to the width of its box.

    `draw` fills the axes, which have `margins` (left, top, bottom) [points]; labelled artists become a legend above
    them. `description` becomes the element's aria-label. Nothing is clipped to the axes, so no
    artist may reach beyond their limits.
    """
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context({**STYLE, "svg.hashsalt": description}):
        figure = Figure(figsize=(width / POINTS_PER_INCH, height / POINTS_PER_INCH))
        left, top, bottom = margins
        box = (left / width, bottom / height, 1.0 - (left + RIGHT) / width, 1.0 - (bottom + top) / height)
        axes = figure.add_axes(box)
        draw(axes)
        handles, labels = axes.get_legend_handles_labels()
        if handles:
            figure.legend(handles, labels, loc="upper right", ncols=len(handles), borderaxespad=0.0, borderpad=0.1)
        written = StringIO()
        figure.savefig(written, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    return _element(written.getvalue(), description, width, height)


def _element(svg: str, description: str, width: float, height: float) -> str:
    """Return the <svg> element of an SVG file, without its size, name spaces, clipping and unused ids."""
    body = svg[svg.index(">", svg.index("<svg")) + 1 :]
    body = re.sub(OUTSIDE, "", body, flags=re.DOTALL)
    body = re.sub(r"<defs>\s*</defs>", "", body)
    used = set(re.findall(r'href="#([^"]*)"', body))
    body = re.sub(r' id="([^"]*)"', lambda found: found[0] if found[1] in used else "", body)
    body = re.sub(r"(font: [\d.]+px) '[^;\"]*", rf"\1 {FONTS}", body)
    body = re.sub(r"\s*\n\s*", "\n", body)
    return f'<svg role="img" aria-label="{escape(description)}" viewBox="0 0 {width:g} {height:g}">{body.rstrip()}'
