"""GIF files: one palette for all frames, and in each frame only what changed."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

_TRANSPARENT = 255  # palette index of a pixel that stays as it was
_SAMPLES = 16  # frames that the palette is made of
_EXACT = 64  # most frequent colours that are in the palette as they are


class GifEncoder:
    """Keeps frames (h, w, 3) uint8, deflated, until `finish` writes them: their palette is made from all of them."""

    def __init__(self, path: Path, fps: float) -> None:
        self.path, self.fps = path, fps
        self._kept: list[bytes] = []
        self._shape: tuple[int, ...] = ()

    def add(self, frame: NDArray[np.uint8]) -> None:
        """Append a frame."""
        self._shape = frame.shape
        self._kept.append(zlib.compress(frame.tobytes(), 1))

    def finish(self) -> None:
        """Write the file; it plays for ever."""
        ends = np.round(100.0 / self.fps * np.arange(len(self._kept) + 1)).astype(int)  # GIF counts in 1/100 s
        frames = self._changes()
        next(frames).save(
            self.path, save_all=True, append_images=frames, duration=(10 * np.diff(ends)).tolist(), loop=0,
            transparency=_TRANSPARENT, disposal=1, optimize=False,
        )  # fmt: skip

    def abandon(self) -> None:
        """Let go of the frames."""
        self._kept.clear()

    def _colours(self, index: int) -> NDArray[np.int32]:
        """Frame number `index` as one number 0xRRGGBB a pixel (h, w)."""
        data = np.frombuffer(zlib.decompress(self._kept[index]), np.uint8).reshape(self._shape).astype(np.int32)
        return data[..., 0] << 16 | data[..., 1] << 8 | data[..., 2]

    def _changes(self) -> Iterator[Image.Image]:
        """The frames in palette colours, transparent where nothing changed."""
        chosen = np.unique(np.linspace(0, len(self._kept) - 1, _SAMPLES).astype(int))
        palette = _Palette(np.stack([self._colours(int(i)) for i in chosen]))
        before: NDArray[np.uint8] | None = None
        for index in range(len(self._kept)):
            now = palette.indices(self._colours(index))
            changed = now if before is None else np.where(now == before, np.uint8(_TRANSPARENT), now)
            before = now
            image = Image.fromarray(changed, "P")
            image.putpalette(palette.flat)
            yield image


class _Palette:
    """At most 255 colours that serve some pictures well."""

    def __init__(self, pictures: NDArray[np.int32]) -> None:
        """`pictures`: 0xRRGGBB of any shape."""
        found, counts = np.unique(pictures, return_counts=True)
        order = np.argsort(-counts, kind="stable")
        exact, rest = order[:_EXACT], order[_EXACT:]
        self._table = _channels(found[exact])
        if rest.size:
            weighted = np.repeat(_channels(found[rest]), np.ceil(np.sqrt(counts[rest])).astype(int), axis=0)
            mixed = Image.fromarray(weighted[None]).quantize(_TRANSPARENT - len(exact), Image.Quantize.MEDIANCUT)
            others = np.array(mixed.getpalette(), np.uint8).reshape(-1, 3)
            self._table = np.concatenate([self._table, others])
        self._known = np.full(1 << 24, -1, np.int16)  # index of each colour, as it is needed

    @property
    def flat(self) -> list[int]:
        """All colours in a row, filled up to 256, as Pillow takes them."""
        return np.vstack([self._table, np.zeros((256 - len(self._table), 3), np.uint8)]).ravel().tolist()

    def indices(self, picture: NDArray[np.int32]) -> NDArray[np.uint8]:
        """The nearest palette colour of each pixel."""
        indices = self._known[picture]
        if (indices < 0).any():
            from scipy.spatial import KDTree

            new = np.unique(picture[indices < 0])
            self._known[new] = KDTree(self._table.astype(float)).query(_channels(new).astype(float))[1]
            indices = self._known[picture]
        return indices.astype(np.uint8)


def _channels(colours: NDArray[np.int32]) -> NDArray[np.uint8]:
    """0xRRGGBB (n,) as (n, 3)."""
    return np.stack([colours >> 16, colours >> 8 & 255, colours & 255], axis=-1).astype(np.uint8)
