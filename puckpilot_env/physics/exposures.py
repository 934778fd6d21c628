"""The puck's places when a camera exposes: the rows of `film`, each a time [s] and, written here, x and y [m]."""

from __future__ import annotations

from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics.sliding import curve, glide


@kernel
def of_glide(film, puck, ux, uy, v, t, until, friction, drag):
    """Note the places of a glide along the unit vector `u`, from the speed `v` [m/s], between `t` and `until` [s]."""
    for i in range(film.shape[0]):
        if t < film[i, 0] <= until:
            path_length = glide.distance(v, film[i, 0] - t, friction, drag)
            film[i, 1], film[i, 2] = puck.x + ux * path_length, puck.y + uy * path_length


@inlined_kernel
def of_leg(film, cx, cy, t, h, until):
    """Note the places of a leg of `h` [s] along the curves `c`, between `t` and `until` [s]."""
    for i in range(film.shape[0]):
        if t < film[i, 0] <= until:
            s = (film[i, 0] - t) / h
            film[i, 1], film[i, 2] = curve.place(cx, s), curve.place(cy, s)
