"""The still part of a table's picture: where things are, the colours, rails, ice, lines and goals."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFilter

from puckpilot_env.rendering.canvas import Colour, Picture

SCALE = 280.0  # pixels a metre: the default table is 640 x 360
SMALLEST, LARGEST = 20.0, 2000.0

PAPER, RAIL, RAIL_EDGE, ICE = (236, 240, 244), (54, 66, 80), (84, 98, 114), (251, 252, 253)
INK, MUTED, MIDDLE = (42, 52, 64), (118, 130, 144), (238, 205, 200)
PUCK, PUCK_RING = (33, 37, 43), (98, 105, 114)
PLAYERS: tuple[Colour, Colour] = ((38, 108, 176), (226, 122, 46))

# Sizes [m] of what has no physics
_SIDE, _TOP, _BOTTOM, RAIL_WIDTH = 40 / 280, 56 / 280, 24 / 280, 14 / 280
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


def mix(a: Colour, b: Colour, share: float) -> Colour:
    """`share` of `b` in `a`."""
    red, green, blue = (round(i + (j - i) * share) for i, j in zip(a, b, strict=True))
    return red, green, blue


@lru_cache(maxsize=8)
def background(place: Layout) -> Picture:
    """All that does not move, drawn large and averaged; not to be written to."""
    large = Layout(place.length, place.width, place.goal_width, place.corner, place.scale * _SUPERSAMPLING)
    size = _SUPERSAMPLING * place.shape[1], _SUPERSAMPLING * place.shape[0]
    image = Image.new("RGB", size, PAPER)
    rail = _corners(large, RAIL_WIDTH)
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
        pen.ellipse((x - r, y - r, x + r, y + r), mix(ICE, PLAYERS[k], 0.07), mix(ICE, PLAYERS[k], 0.35), round(line))
    x, y = place.pixel(0.5 * place.length, 0.5 * place.width)
    pen.rectangle((x - 0.6 * line, 0, x + 0.6 * line, size[1]), MIDDLE)
    for radius, fill in ((0.16 * place.width, None), (0.014, MIDDLE)):
        r = radius * place.scale
        pen.ellipse((x - r, y - r, x + r, y + r), fill, MIDDLE, round(1.2 * line))
    return image


def _draw_goals(pen: ImageDraw.ImageDraw, place: Layout) -> None:
    """The goal mouths: pockets in the rail, with the player's colour at their back."""
    depth = 0.75 * RAIL_WIDTH
    for k, player in enumerate(PLAYERS):
        for inner, outer, colour in ((0.0, depth, mix(ICE, player, 0.25)), (depth - 0.009, depth, player)):
            x0, x1 = (-outer, -inner) if k == 0 else (place.length + inner, place.length + outer)
            left, top = place.pixel(x0, 0.5 * (place.width + place.goal_width))
            right, bottom = place.pixel(x1, 0.5 * (place.width - place.goal_width))
            pen.rectangle((left, top, right - 1, bottom - 1), colour)
