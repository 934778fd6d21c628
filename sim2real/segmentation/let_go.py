"""Which launches begin with a puck that a hand let go, hardly turning it, and not in the midst of play.

Hits that follow each other within frames look like an interruption of the motion, too: the path jumps, but not farther
than a fast puck gets meanwhile.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim2real.segmentation.tuned import SEGMENTATION


def let_go(t: np.ndarray, p: np.ndarray, launches: Sequence[tuple[int, int]]) -> tuple[bool, ...]:
    """Whether each of `launches`, (start, stop) frames, begins so. `t` (frames,) [s]; `p` (frames, 2) [m], nan where
    the puck is not seen. Unknown, and so False, after frames that are left out, as those of a holdout are."""
    period = float(np.median(np.diff(t))) if len(t) > 1 else 0.0
    before = [None, *(stop - 1 for _, stop in launches)]
    return tuple(_is_let_go(t, p, start, last, period) for (start, _), last in zip(launches, before, strict=False))


def _is_let_go(t: np.ndarray, p: np.ndarray, start: int, last: int | None, period: float) -> bool:
    if last is None:
        return True
    if np.diff(t[last : start + 1]).max() > SEGMENTATION.left_out * period:
        return False
    pause = float(t[start] - t[last])
    far = float(np.linalg.norm(p[start] - p[last])) > SEGMENTATION.fastest * pause + SEGMENTATION.place_slack
    return far or pause > SEGMENTATION.handling
