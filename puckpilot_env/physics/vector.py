"""The length of a plane vector."""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel


@kernel
def size(x, y):
    """sqrt(x^2 + y^2). The library's hypot takes four times as long to guard against overflows that no table knows."""
    return math.sqrt(x * x + y * y)
