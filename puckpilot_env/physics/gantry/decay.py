"""How a mode of a gantry dies out: exponentials, without the library's where that is quicker."""

from __future__ import annotations

import math

from puckpilot_env.kernel import inlined_kernel

NEGLIGIBLE = 40.0  # exp(-40) of a fast mode (under 1 mm) is under 1e-20 m
_SLIGHT = 2.25  # up to here `decay` is a fraction; a slow mode decays by no more in 0.1 s


@inlined_kernel
def decay(exponent):
    """exp(-exponent) of an exponent >= 0, to 3e-15 of it; the library's takes twice as long.

    Pade's fraction of degree 5 for an eighth of the exponent, three times squared.
    """
    if exponent > _SLIGHT:
        return math.exp(-exponent)
    x = 0.125 * exponent
    x2 = x * x
    even = 30240.0 + x2 * (3360.0 + 30.0 * x2)
    odd = x * (15120.0 + x2 * (420.0 + x2))
    root = (even - odd) / (even + odd)
    root *= root
    root *= root
    return root * root


@inlined_kernel
def fade(rate, t):
    """exp(-rate t), 0 where that no longer matters."""
    exponent = rate * t
    return math.exp(-exponent) if exponent < NEGLIGIBLE else 0.0
