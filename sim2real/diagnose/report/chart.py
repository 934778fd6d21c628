"""Small charts as inline SVG: axes with ticks, lines, bands, points with errors, arrows."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from sim2real.diagnose.report.words import text

BEFORE, AFTER, INK, FAINT, GRID = "#D55E00", "#0072B2", "#1a1a1a", "#b0b0b0", "#e5e5e5"
LEFT, RIGHT, TOP, BOTTOM = 68, 10, 10, 36
LETTER = 6.2  # width of one at the font's size


@dataclass
class Chart:
    """A chart of data from `low` to `high` (2,), in a picture of `width` and `height`, labelled `x` and `y`.

    `square`: one unit is as long along both axes, and the height follows. `ticks`: names for x = 0, 1, …
    """

    low: tuple[float, float]
    high: tuple[float, float]
    x: str
    y: str
    width: int = 360
    height: int = 170
    square: bool = False
    ticks: Sequence[str] = ()
    parts: list[str] = field(default_factory=list)
    names: list[tuple[str, str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        if self.square:
            tall = (self.width - LEFT - RIGHT) * (self.high[1] - self.low[1]) / (self.high[0] - self.low[0])
            self.height = round(tall) + TOP + BOTTOM

    def at(self, x, y) -> np.ndarray:
        """Data (n,), (n,) as places (n, 2) in the picture."""
        u = (np.asarray(x, float) - self.low[0]) / (self.high[0] - self.low[0])
        w = (np.asarray(y, float) - self.low[1]) / (self.high[1] - self.low[1])
        across, down = self.width - LEFT - RIGHT, self.height - TOP - BOTTOM
        return np.stack([LEFT + across * u, self.height - BOTTOM - down * w], axis=-1)

    def name(self, words: str, colour: str) -> None:
        """An entry of the legend."""
        self.names.append((words, colour))

    def line(self, x, y, colour: str, dashed: bool = False, thick: float = 1.6) -> None:
        """A line through points."""
        dash = ' stroke-dasharray="5 3"' if dashed else ""
        self.parts.append(
            f'<polyline points="{_path(self.at(x, y))}" fill="none" stroke="{colour}" stroke-width="{thick}"{dash}/>'
        )

    def band(self, x, low, high, colour: str) -> None:
        """The area between two curves."""
        edge = np.concatenate([self.at(x, low), self.at(x, high)[::-1]])
        self.parts.append(f'<polygon points="{_path(edge)}" fill="{colour}" fill-opacity="0.25"/>')

    def points(self, x, y, error, colour: str, square: bool = False) -> None:
        """Points with bars of `error` (n,) both ways."""
        places, low, high = self.at(x, y), self.at(x, y - error), self.at(x, y + error)
        bars = "".join(f"M{_pair(a)}V{b[1]:.1f}" for a, b in zip(low, high, strict=True))
        self.parts.append(f'<path d="{bars}" stroke="{colour}" stroke-width="1.1"/>')
        for px, py in places:
            mark = (
                f'<rect x="{px - 2.8:.1f}" y="{py - 2.8:.1f}" width="5.6" height="5.6" fill="{colour}"/>'
                if square
                else f'<circle cx="{px:.1f}" cy="{py:.1f}" r="3" fill="{colour}"/>'
            )
            self.parts.append(mark)

    def arrow(self, start: np.ndarray, vector: np.ndarray, colour: str) -> None:
        """An arrow from a place, by a vector in the data's units."""
        a, b = self.at(*start), self.at(*(start + vector))
        along = b - a
        size = float(np.hypot(*along))
        if size < 1.5:
            self.parts.append(f'<circle cx="{a[0]:.1f}" cy="{a[1]:.1f}" r="1.2" fill="{colour}"/>')
            return
        along /= size
        across, head = np.array([-along[1], along[0]]), min(6.0, 0.5 * size)
        tip = "L".join(
            _pair(p) for p in (b - head * along + 0.5 * head * across, b, b - head * along - 0.5 * head * across)
        )
        self.parts.append(f'<path d="M{_pair(a)}L{_pair(b)}M{tip}" fill="none" stroke="{colour}" stroke-width="1.6"/>')

    def svg(self, told: str) -> str:
        """The picture; `told` describes it to those who do not see it."""
        clip = f"{LEFT} {TOP} {self.width - LEFT - RIGHT} {self.height - TOP - BOTTOM}".split()
        window = (
            f'<svg x="{clip[0]}" y="{clip[1]}" width="{clip[2]}" height="{clip[3]}" viewBox="{" ".join(clip)}">'
            f"{''.join(self.parts)}</svg>"
        )
        return (
            f'<svg class="chart" role="img" aria-label="{text(told)}" viewBox="0 0 {self.width} {self.height}" '
            f'font-size="11" font-family="system-ui, sans-serif" fill="{INK}">'
            f"{self._axes()}{window}{self._legend()}</svg>"
        )

    def _axes(self) -> str:
        right, bottom = self.width - RIGHT, self.height - BOTTOM
        found = []
        for value, name in self._x_ticks():
            px = self.at(value, self.low[1])[0]
            found.append(f'<path d="M{px:.1f} {TOP}V{bottom}" stroke="{GRID}"/>')
            found.append(f'<text x="{px:.1f}" y="{bottom + 14}" text-anchor="middle">{text(name)}</text>')
        for value in nice(self.low[1], self.high[1], 5):
            py = self.at(self.low[0], value)[1]
            shade = FAINT if value == 0.0 else GRID
            found.append(f'<path d="M{LEFT} {py:.1f}H{right}" stroke="{shade}"/>')
            found.append(f'<text x="{LEFT - 5}" y="{py + 4:.1f}" text-anchor="end">{value:g}</text>')
        middle = (TOP + bottom) / 2
        found.append(f'<path d="M{LEFT} {TOP}V{bottom}H{right}" fill="none" stroke="{INK}"/>')
        found.append(f'<text x="{(LEFT + right) / 2}" y="{self.height - 5}" text-anchor="middle">{text(self.x)}</text>')
        for k, line in enumerate(self._y_lines()):
            place = f'transform="translate({11 + 12 * k} {middle}) rotate(-90)" text-anchor="middle"'
            found.append(f"<text {place}>{text(line)}</text>")
        return "".join(found)

    def _y_lines(self) -> list[str]:
        """The label of the upright axis, its unit on a line of its own where both are too long for one."""
        room = self.height - BOTTOM + TOP
        name, bracket, unit = self.y.partition(" [")
        return [name, f"[{unit}"] if bracket and LETTER * len(self.y) > room else [self.y]

    def _x_ticks(self) -> list[tuple[float, str]]:
        if self.ticks:
            return [(float(k), name) for k, name in enumerate(self.ticks)]
        return [(value, f"{value:g}") for value in nice(self.low[0], self.high[0], 6)]

    def _legend(self) -> str:
        found, right = [], self.width - RIGHT - 4.0
        for words, colour in reversed(self.names):
            right -= LETTER * len(words) + 16
            found.append(
                f'<rect x="{right - 2:.0f}" y="{TOP}" width="{LETTER * len(words) + 16:.0f}" height="15" fill="#fff" '
                f'fill-opacity="0.8"/><rect x="{right:.0f}" y="{TOP + 3}" width="9" height="9" fill="{colour}"/>'
                f'<text x="{right + 12:.0f}" y="{TOP + 11}">{text(words)}</text>'
            )
        return "".join(found)


def nice(low: float, high: float, count: int) -> list[float]:
    """About `count` round numbers from `low` to `high`."""
    rough = (high - low) / max(count, 1)
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(power * k for k in (1, 2, 5, 10) if power * k >= 0.999 * rough)
    first, last = math.ceil(low / step - 1e-9), math.floor(high / step + 1e-9)
    return [round(k * step, 12) + 0.0 for k in range(first, last + 1)]


def span(*values: np.ndarray, margin: float = 0.06) -> tuple[float, float]:
    """The range of all `values`, a little wider."""
    every = np.concatenate([np.ravel(each) for each in values])
    every = every[np.isfinite(every)]
    if not len(every):
        return 0.0, 1.0
    low, high = float(every.min()), float(every.max())
    more = margin * (high - low) or max(abs(high), 1.0) * margin
    return low - more, high + more


def _pair(place: np.ndarray) -> str:
    return f"{place[0]:.1f} {place[1]:.1f}"


def _path(places: np.ndarray) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
