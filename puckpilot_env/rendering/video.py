"""Films as files: `VideoWriter` writes a .gif or a .mp4, whole or not at all."""

from __future__ import annotations

import os
from pathlib import Path
from types import TracebackType
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.files.whole_file import draft_of
from puckpilot_env.rendering.gif import GifEncoder

MOST_GIF_FPS = 50.0  # browsers slow faster ones down


class _Encoder(Protocol):
    """Makes a file of frames; `abandon` lets go of it, at any time and more than once."""

    def add(self, frame: NDArray[np.uint8]) -> None: ...

    def finish(self) -> None: ...

    def abandon(self) -> None: ...


class VideoWriter:
    """Takes frames (h, w, 3) uint8, all of one shape, and makes a film of them; use it in a `with` statement.

    The file appears when the block ends well; when it ends in an exception, what was there before stays.
    """

    def __init__(self, path: str | os.PathLike[str], fps: float = 25.0) -> None:
        """`fps`: frames a second. ValueError for another ending than .gif and .mp4, for an impossible `fps` and for a
        folder that is not there, in one line."""
        self.path = Path(path)
        self.fps = float(fps)
        self.frames = 0
        ending = self.path.suffix.lower()
        if ending not in (".gif", ".mp4"):
            raise ValueError(f"cannot write {str(self.path)!r} as a film; expected a name that ends in .gif or .mp4")
        most = MOST_GIF_FPS if ending == ".gif" else 240.0
        if not 1.0 <= self.fps <= most:
            raise ValueError(f"fps is {fps!r}; expected a number from 1 to {most:g} for a {ending} film")
        if not self.path.parent.is_dir():
            raise ValueError(f"cannot write {str(self.path)!r}: its folder does not exist; make it first")
        if self.path.is_dir():
            raise ValueError(f"cannot write {str(self.path)!r}: it is a folder; give a file name")
        self._draft = draft_of(self.path)
        make = GifEncoder if ending == ".gif" else _Mp4Encoder
        self._encoder: _Encoder = make(self._draft, self.fps)
        self._shape: tuple[int, ...] | None = None

    def add(self, frame: NDArray[np.uint8]) -> None:
        """Append a frame. ValueError if it is not (h, w, 3) uint8 or of another shape than the first."""
        frame = np.asarray(frame)
        if frame.dtype != np.uint8 or frame.ndim != 3 or frame.shape[2] != 3:
            raise ValueError(f"a frame is {frame.dtype} of shape {frame.shape}; expected uint8 of shape (h, w, 3)")
        if self._shape is not None and frame.shape != self._shape:
            raise ValueError(f"a frame has shape {frame.shape}; expected {self._shape}, as the first one")
        self._shape = frame.shape
        self._encoder.add(frame)
        self.frames += 1

    def close(self) -> None:
        """Finish the film and put it in its place. ValueError if it has no frames."""
        try:
            if not self.frames:
                raise ValueError(f"no frames were added to {str(self.path)!r}; nothing is written")
            self._encoder.finish()
            self._draft.replace(self.path)
        finally:
            self._discard()

    def _discard(self) -> None:
        self._encoder.abandon()
        self._draft.unlink(missing_ok=True)

    def __enter__(self) -> VideoWriter:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self.close()
        else:
            self._discard()


class _Mp4Encoder:
    """Hands the frames to OpenCV as they come: VP9, which browsers play, or else MPEG-4."""

    def __init__(self, path: Path, fps: float) -> None:
        self.path, self.fps = path, fps
        self._writer = None

    def add(self, frame: NDArray[np.uint8]) -> None:
        if self._writer is None:
            self._writer = self._open(frame.shape)
        self._writer.write(np.ascontiguousarray(frame[..., ::-1]))

    def _open(self, shape: tuple[int, ...]):
        import cv2

        if shape[0] % 2 or shape[1] % 2:
            raise ValueError(f"a frame has shape {shape}; expected even height and width for a .mp4 film")
        for codec in ("vp09", "mp4v"):
            fourcc = cv2.VideoWriter.fourcc(*codec)
            writer = cv2.VideoWriter(str(self.path), fourcc, self.fps, (shape[1], shape[0]))
            if writer.isOpened():
                return writer
        raise OSError(f"OpenCV cannot write a film in {str(self.path.parent)!r}; see that it can be written to")

    def finish(self) -> None:
        self.abandon()

    def abandon(self) -> None:
        if self._writer is not None:
            self._writer.release()
            self._writer = None
