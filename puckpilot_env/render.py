"""A picture of a table: `draw`. What `rgb_array` renders, what films and documentation pages are made of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from PIL import Image, ImageDraw, ImageFilter

from puckpilot_env import canvas
from puckpilot_env.canvas import Colour, Picture
from puckpilot_env.game.start import MATCH
from puckpilot_env.tables import Tables
from puckpilot_env.trace import trace as trace_motion
from puckpilot_env.variants import Variant

SCALE = 280.0  # pixels a metre: the default table is 640 x 360
SMALLEST, LARGEST = 20.0, 2000.0

PAPER, RAIL, RAIL_EDGE, ICE = (236, 240, 244), (54, 66, 80), (84, 98, 114), (251, 252, 253)
INK, MUTED, MIDDLE = (42, 52, 64), (118, 130, 144), (238, 205, 200)
PUCK, PUCK_RING = (33, 37, 43), (98, 105, 114)
PLAYERS: tuple[Colour, Colour] = ((38, 108, 176), (226, 122, 46))

# Sizes [m] of what has no physics
_SIDE, _TOP, _BOTTOM, _RAIL = 40 / 280, 56 / 280, 24 / 280, 14 / 280
_SUPERSAMPLING = 4  # of the background, drawn once

_Number = TypeVar("_Number", float, NDArray[np.float64])


@dataclass(frozen=True)
class Layout:
    """Where a table lies in its picture: `scale` in pixels a metre, the rest in metres."""

    length: float
    width: float
    goal_width: float
    corner: float  # radius of the rounded corners: the puck's, so that they are in nothing's way
    scale: float

    @property
    def shape(self) -> tuple[int, int]:
        """`(h, w)` of the picture in pixels; even, as films want it."""
        height = 2 * round(0.5 * self.scale * (self.width + _TOP + _BOTTOM))
        return height, 2 * round(0.5 * self.scale * (self.length + 2 * _SIDE))

    def pixel(self, x: _Number, y: _Number) -> tuple[_Number, _Number]:
        """The place `(x, y)` [m] of the table in the picture (see `canvas`): x to the right, y upwards."""
        return self.scale * (_SIDE + x), self.scale * (_TOP + self.width - y)


def layout(p: np.void, scale: float = SCALE) -> Layout:
    """The layout of a table with parameters `p` (`parameters.RECORD`). ValueError for an impossible scale."""
    if not SMALLEST <= scale <= LARGEST:
        raise ValueError(f"scale is {scale!r}; expected a number from {SMALLEST:g} to {LARGEST:g} pixels a metre")
    return Layout(float(p["length"]), float(p["width"]), float(p["goal_width"]), float(p["puck_radius"]), float(scale))


def draw(
    table: np.void,
    p: np.void,
    *,
    scale: float = SCALE,
    names: Sequence[str] = ("player_0", "player_1"),
    trail: ArrayLike | None = None,
    rules: np.void | None = None,
    note: str | None = None,
) -> Picture:
    """A picture (h, w, 3) uint8 of one table, x to the right and y upwards.

    table: a `state.TABLE` record; p: its parameters; scale: pixels a metre; trail: where the puck was (m, 2) [m],
    oldest first; rules: a `rules.RULES` record, by which a match shows score and time left, and a drill the time since
    it began; note: a word in place of the time.
    """
    place = layout(p, scale)
    picture = _background(place).copy()
    if trail is not None and np.size(trail):
        _draw_trail(picture, place, np.asarray(trail, np.float64), p)
    mallets = table["modes"].sum(axis=2)
    for k in range(2):
        _draw_beam(picture, place, mallets[k, 0], p, k)
    _draw_puck(picture, place, table["puck"], p)
    for k in range(2):
        _draw_mallet(picture, place, mallets[k], p, k)
    _draw_header(picture, place, table, names, rules, note)
    return picture


def draw_start(variant: Variant, *, seed: int = 0, steps: int = 5, scale: float = SCALE) -> Picture:
    """A picture (h, w, 3) uint8 of how an episode of a variant may begin: the puck's way through its first steps.

    The mallets move to random places, at half of the highest voltage; the same `seed` gives the same picture.
    """
    tables = Tables(variant, 1, seed=seed, autoreset=False)
    random = np.random.default_rng(seed)
    low, high = tables.action_bounds
    times = np.linspace(0.0, tables.variant.period, 21)
    moment, trail = tables.states[0].copy(), [tables.states["puck"][0, :2].copy()]
    for _ in range(steps):
        actions = random.uniform(low, high, (1, 2, 4)).astype(np.float32)
        actions[..., 2:] = 0.5 * high[2:]
        moments, scored = trace_motion(tables, 0, actions[0], times)
        trail.extend(moments["puck"][:, :2])
        moment = moments[-1]
        tables.step(actions)
        if scored[-1] or tables.terminated[0] or tables.truncated[0]:
            break
    return draw(moment, tables.params[0], scale=scale, trail=trail, rules=variant.rules()[0])


def _draw_trail(picture: Picture, place: Layout, trail: NDArray[np.float64], p: np.void) -> None:
    x, y = place.pixel(trail[:, 0], trail[:, 1])
    points = np.stack([x, y], axis=1)
    far = np.hypot(*np.diff(points[::-1], axis=0).T).cumsum()  # from the newest point back
    _, kept = np.unique(np.floor(np.concatenate([[0.0], far]) / 3.0), return_index=True)
    canvas.trail(picture, points[::-1][kept][::-1], 0.8 * p["puck_radius"] * place.scale, PUCK, 0.3)


def _draw_beam(picture: Picture, place: Layout, x: float, p: np.void, player: int) -> None:
    """The gantry beam over the player's mallet, resting on both rails."""
    middle, top = place.pixel(x, place.width)
    bottom = place.pixel(x, 0.0)[1]
    half, rail = max(0.5 * p["beam_width"] * place.scale, 1.0), 0.7 * _RAIL * place.scale
    colour = PLAYERS[player]
    canvas.box(picture, middle - half, top, middle + half, bottom, colour, 0.13)
    edge = 0.004 * place.scale
    for x_edge in (middle - half, middle + half - edge):
        canvas.box(picture, x_edge, top, x_edge + edge, bottom, colour, 0.18)
    for end in (top - rail, bottom):
        canvas.box(picture, middle - half, end, middle + half, end + rail, colour, 0.75)


def _draw_puck(picture: Picture, place: Layout, puck: NDArray[np.float64], p: np.void) -> None:
    x, y = place.pixel(puck[0], puck[1])
    radius = p["puck_radius"] * place.scale
    canvas.disc(picture, x, y + 0.12 * radius, 1.1 * radius, INK, 0.25, 0.5 * radius)
    canvas.disc(picture, x, y, radius, PUCK)
    canvas.disc(picture, x, y, 0.66 * radius, PUCK_RING)
    canvas.disc(picture, x, y, 0.52 * radius, PUCK)


def _draw_mallet(picture: Picture, place: Layout, mallet: NDArray[np.float64], p: np.void, player: int) -> None:
    x, y = place.pixel(mallet[0], mallet[1])
    radius, colour = p["mallet_radius"] * place.scale, PLAYERS[player]
    canvas.disc(picture, x, y + 0.1 * radius, 1.08 * radius, INK, 0.3, 0.4 * radius)
    canvas.disc(picture, x, y, radius, _mix(colour, INK, 0.12))
    canvas.disc(picture, x, y, 0.86 * radius, colour)
    canvas.disc(picture, x, y, 0.66 * radius, _mix(colour, ICE, 0.22))
    canvas.disc(picture, x, y + 0.06 * radius, 0.44 * radius, INK, 0.3, 0.3 * radius)
    canvas.disc(picture, x, y, 0.4 * radius, colour)
    x, y = x - 0.06 * radius, y - 0.08 * radius
    canvas.disc(picture, x, y, 0.2 * radius, _mix(colour, ICE, 0.35), 0.8, 0.25 * radius)


def _draw_header(
    picture: Picture, place: Layout, table: np.void, names: Sequence[str], rules: np.void | None, note: str | None
) -> None:
    """Names, who defends, score and time."""
    unit = place.scale / SCALE
    middle, _ = place.pixel(0.5 * place.length, 0.0)
    time_left = rules["match_time"] - table["time"] if rules is not None and rules["game"] == MATCH else None
    has_score = rules is None or time_left is not None
    room = middle - place.pixel(0.0, 0.0)[0] - 50 * unit
    for k in range(2):
        _draw_name(picture, place, names[k], "defends" if table["defending"][k] else "attacks", k, room)
    small = max(round(12 * unit), 6)
    if has_score:
        big = max(round(21 * unit), 8)
        canvas.text(picture, middle, 14 * unit, ":", big, MUTED, 0.5)
        for k, side in ((0, -1), (1, 1)):
            canvas.text(picture, middle + side * 9 * unit, 14 * unit, f"{table['score'][k]}", big, PLAYERS[k], k == 0)
    if note is None:
        note = f"{table['time']:.1f} s" if time_left is None else clock(time_left)
    canvas.text(picture, middle, (32 if has_score else 21) * unit, note, small, MUTED, 0.5)


def _draw_name(picture: Picture, place: Layout, name: str, role: str, player: int, room: float) -> None:
    """A player's dot, name and role, at its end of the table; the name is cut to `room` pixels."""
    unit = place.scale / SCALE
    size, small = max(round(15 * unit), 7), max(round(12 * unit), 6)
    side = 1 if player == 0 else -1
    x, _ = place.pixel(0.0 if player == 0 else place.length, 0.0)
    x, y = x - side * 8 * unit, 21 * unit
    room -= canvas.text_width(role, small) + 30 * unit
    kept = len(name)
    while kept > 1 and canvas.text_width(name, size) > room:
        kept -= 1
        name = name[:kept].rstrip() + "\u2026"
    canvas.disc(picture, x + side * 6 * unit, y, 5.5 * unit, PLAYERS[player])
    x += side * 18 * unit
    x += side * (canvas.text(picture, x, y, name, size, INK, player) + 8 * unit)
    canvas.text(picture, x, y + 1 * unit, role, small, MUTED, player)


def clock(seconds: float) -> str:
    """Time left as minutes and seconds, `2:05`."""
    whole = max(math.ceil(seconds - 1e-6), 0)
    return f"{whole // 60}:{whole % 60:02d}"


def _mix(a: Colour, b: Colour, share: float) -> Colour:
    """`share` of `b` in `a`."""
    red, green, blue = (round(i + (j - i) * share) for i, j in zip(a, b, strict=True))
    return red, green, blue


@lru_cache(maxsize=8)
def _background(place: Layout) -> Picture:
    """All that does not move, drawn large and averaged; not to be written to."""
    large = Layout(place.length, place.width, place.goal_width, place.corner, place.scale * _SUPERSAMPLING)
    size = _SUPERSAMPLING * place.shape[1], _SUPERSAMPLING * place.shape[0]
    image = Image.new("RGB", size, PAPER)
    rail = _corners(large, _RAIL)
    shadow = Image.new("L", size)
    ImageDraw.Draw(shadow).rounded_rectangle(rail, 0.06 * large.scale, fill=70)
    image.paste(RAIL, mask=shadow.filter(ImageFilter.GaussianBlur(0.025 * large.scale)))
    pen = ImageDraw.Draw(image)
    pen.rounded_rectangle(rail, 0.06 * large.scale, fill=RAIL)
    pen.rounded_rectangle(_corners(large, 0.008), large.corner * large.scale, fill=RAIL_EDGE)
    ice = Image.new("L", size)
    ImageDraw.Draw(ice).rounded_rectangle(_corners(large, 0.0), large.corner * large.scale, fill=255)
    image.paste(_markings(large, size), mask=ice)
    _draw_goals(pen, large)
    finished = np.asarray(image.reduce(_SUPERSAMPLING)).copy()
    finished.flags.writeable = False
    return finished


def _corners(place: Layout, margin: float) -> tuple[float, float, float, float]:
    """Left, top, right, bottom in Pillow's pixels of the playing surface with a margin [m] around."""
    left, top = place.pixel(-margin, place.width + margin)
    right, bottom = place.pixel(place.length + margin, -margin)
    return left, top, right - 1, bottom - 1


def _markings(place: Layout, size: tuple[int, int]) -> Image.Image:
    """The ice with its lines."""
    image = Image.new("RGB", size, ICE)
    pen = ImageDraw.Draw(image)
    line = 0.007 * place.scale
    for k, end in enumerate((0.0, place.length)):
        x, y = place.pixel(end, 0.5 * place.width)
        r = 0.8 * place.goal_width * place.scale
        pen.ellipse((x - r, y - r, x + r, y + r), _mix(ICE, PLAYERS[k], 0.07), _mix(ICE, PLAYERS[k], 0.35), round(line))
    x, y = place.pixel(0.5 * place.length, 0.5 * place.width)
    pen.rectangle((x - 0.6 * line, 0, x + 0.6 * line, size[1]), MIDDLE)
    for radius, fill in ((0.16 * place.width, None), (0.014, MIDDLE)):
        r = radius * place.scale
        pen.ellipse((x - r, y - r, x + r, y + r), fill, MIDDLE, round(1.2 * line))
    return image


def _draw_goals(pen: ImageDraw.ImageDraw, place: Layout) -> None:
    """The goal mouths: pockets in the rail, with the player's colour at their back."""
    depth = 0.75 * _RAIL
    for k, player in enumerate(PLAYERS):
        for inner, outer, colour in ((0.0, depth, _mix(ICE, player, 0.25)), (depth - 0.009, depth, player)):
            x0, x1 = (-outer, -inner) if k == 0 else (place.length + inner, place.length + outer)
            left, top = place.pixel(x0, 0.5 * (place.width + place.goal_width))
            right, bottom = place.pixel(x1, 0.5 * (place.width - place.goal_width))
            pen.rectangle((left, top, right - 1, bottom - 1), colour)
