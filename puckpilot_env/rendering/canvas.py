"""Anti-aliased shapes and words on an RGB picture, exact to a fraction of a pixel. Knows nothing of the game.

A picture is a uint8 array (h, w, 3), drawn on in place; what lies outside is cut off. Places are in pixels from the top
left corner of the picture, so that pixel (row i, column j) has its centre at x = j + 0.5, y = i + 0.5.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Picture = NDArray[np.uint8]
Colour = tuple[int, int, int]


def _window(picture: NDArray, left: float, top: float, right: float, bottom: float) -> tuple[slice, slice]:
    """Rows and columns of the pixels that a box touches."""
    height, width = picture.shape[:2]
    columns = slice(max(int(np.floor(left)), 0), max(min(int(np.ceil(right)), width), 0))
    return slice(max(int(np.floor(top)), 0), max(min(int(np.ceil(bottom)), height), 0)), columns


def _blend(picture: Picture, window: tuple[slice, slice], colour: Colour, cover: NDArray[np.floating]) -> None:
    """Lay `colour` over the window, as opaque as `cover` (rows, columns) in 0..1 says."""
    under = picture[window].astype(np.float32)
    under += (np.array(colour, np.float32) - under) * cover[..., None].astype(np.float32)
    picture[window] = (under + 0.5).astype(np.uint8)


def _centres(window: tuple[slice, slice]) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """x as a row and y as a column of the window's pixel centres."""
    rows, columns = window
    x = np.arange(columns.start, max(columns.stop, columns.start), dtype=np.float32) + np.float32(0.5)
    y = np.arange(rows.start, max(rows.stop, rows.start), dtype=np.float32) + np.float32(0.5)
    return x[None, :], y[:, None]


def disc(picture: Picture, x: float, y: float, radius: float, colour: Colour, alpha: float = 1.0, soft: float = 1.0):
    """A disc whose edge fades over `soft` pixels (1: anti-aliased; more: a shadow)."""
    reach = radius + 0.5 * soft
    window = _window(picture, x - reach, y - reach, x + reach, y + reach)
    px, py = _centres(window)
    cover = np.clip((radius - np.hypot(px - x, py - y)) / soft + 0.5, 0.0, 1.0)
    if soft > 1.0:
        cover = cover * cover * (3.0 - 2.0 * cover)
    _blend(picture, window, colour, alpha * cover)


def box(picture: Picture, left: float, top: float, right: float, bottom: float, colour: Colour, alpha: float = 1.0):
    """An upright rectangle."""
    window = _window(picture, left, top, right, bottom)
    px, py = _centres(window)
    across = np.clip(np.minimum(px + 0.5, right) - np.maximum(px - 0.5, left), 0.0, 1.0)
    down = np.clip(np.minimum(py + 0.5, bottom) - np.maximum(py - 0.5, top), 0.0, 1.0)
    _blend(picture, window, colour, alpha * down * across)


def trail(picture: Picture, points: NDArray[np.floating], radius: float, colour: Colour, alpha: float):
    """A line through `points` (m, 2), oldest first, that widens to `radius` and darkens to `alpha` at the last."""
    points = points.astype(np.float32)
    if len(points) < 2:
        return
    low, high = points.min(axis=0) - radius - 1.0, points.max(axis=0) + radius + 1.0
    window = _window(picture, low[0], low[1], high[0], high[1])
    cover = np.zeros((max(window[0].stop - window[0].start, 0), max(window[1].stop - window[1].start, 0)), np.float32)
    if not cover.size:
        return
    share = np.linspace(0.0, 1.0, len(points), dtype=np.float32)
    for i in range(len(points) - 1):
        _stroke(cover, window, points[i], points[i + 1], share[i], share[i + 1], radius)
    _blend(picture, window, colour, alpha * cover)


def _stroke(cover, window, a, b, share_a, share_b, radius):
    """Raise `cover` where the piece of a trail from `a` to `b` lies; share: 0 at the oldest point, 1 at the last."""
    corner = np.array([window[1].start, window[0].start], np.float32)
    a, b = a - corner, b - corner
    low, high = np.minimum(a, b) - radius - 1.0, np.maximum(a, b) + radius + 1.0
    near = _window(cover, low[0], low[1], high[0], high[1])
    px, py = _centres(near)
    dx, dy = px - a[0], py - a[1]
    along_x, along_y = b - a
    length2 = along_x * along_x + along_y * along_y
    part = np.clip((dx * along_x + dy * along_y) / length2, 0.0, 1.0) if length2 > 0.0 else np.float32(1.0)
    away = np.hypot(dx - part * along_x, dy - part * along_y)
    share = share_a + (share_b - share_a) * part
    piece = np.clip(radius * (0.25 + 0.75 * share) - away + 0.5, 0.0, 1.0) * share * share
    np.maximum(cover[near], piece, out=cover[near])


def text(picture: Picture, x: float, y: float, words: str, size: int, colour: Colour, align: float = 0.0) -> float:
    """Words centred on height `y`; `align` 0 puts their left end at `x`, 0.5 the middle, 1 the right end.

    Returns their width in pixels.
    """
    mask = _letters(words, size)
    height, width = mask.shape
    top, left = round(y - 0.5 * height), round(x - align * width)
    window = _window(picture, left, top, left + width, top + height)
    seen = mask[window[0].start - top : window[0].stop - top, window[1].start - left : window[1].stop - left]
    _blend(picture, window, colour, seen)
    return float(width)


def text_width(words: str, size: int) -> float:
    """Width of words in pixels."""
    return float(_letters(words, size).shape[1])


@lru_cache(maxsize=512)
def _letters(words: str, size: int) -> NDArray[np.float32]:
    """Coverage (h, w) of words in Pillow's own font; the height is the same for all words of a size."""
    font = ImageFont.load_default(size)
    width = max(round(font.getlength(words)), 1)
    image = Image.new("L", (width + 2, round(1.4 * size)))
    ImageDraw.Draw(image).text((1, 0.7 * size), words, fill=255, font=font, anchor="lm")
    return np.asarray(image, np.float32) / 255.0
