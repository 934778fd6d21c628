"""A leg's path along one axis: a polynomial of degree 5 in the share `s` of the leg's time, from 0 to 1.

It has place, velocity and acceleration of both ends (quintic Hermite), so that within a leg it is as exact as they are.
Its coefficients are a tuple `c`, of s^0 first.
"""

from __future__ import annotations

from puckpilot_env.kernel import inlined_kernel


@inlined_kernel
def through(x0, v0, a0, x1, v1, a1, h):
    """The polynomial through both ends of a leg of `h` [s]."""
    d, p, q = x1 - x0, h * v0, h * v1
    k, m = 0.5 * h * h * a0, 0.5 * h * h * a1
    return (
        x0,
        p,
        k,
        10.0 * d - 6.0 * p - 4.0 * q - 3.0 * k + m,
        -15.0 * d + 8.0 * p + 7.0 * q + 3.0 * k - 2.0 * m,
        6.0 * d - 3.0 * p - 3.0 * q - k + m,
    )


@inlined_kernel
def place(c, s):
    """Place at the share `s`."""
    return c[0] + s * (c[1] + s * (c[2] + s * (c[3] + s * (c[4] + s * c[5]))))


@inlined_kernel
def rate(c, s):
    """d place/ds at the share `s`."""
    return c[1] + s * (2.0 * c[2] + s * (3.0 * c[3] + s * (4.0 * c[4] + s * (5.0 * c[5]))))


@inlined_kernel
def bends(c):
    """The four control points of d^2 place/ds^2, in whose hull it lies from s = 0 to 1."""
    first = 2.0 * c[2]
    return first, first + 2.0 * c[3], first + 4.0 * c[3] + 4.0 * c[4], first + 6.0 * c[3] + 12.0 * c[4] + 20.0 * c[5]


@inlined_kernel
def most_bend(c):
    """A bound on abs(d^2 place/ds^2) from s = 0 to 1."""
    first, second, third, last = bends(c)
    return max(max(abs(first), abs(last)), max(abs(second), abs(third)))


@inlined_kernel
def most_bend_along(cx, cy, nx, ny):
    """A bound on n (d^2 place/ds^2) from s = 0 to 1, along the unit vector `n`."""
    x, y = bends(cx), bends(cy)
    first, last = nx * x[0] + ny * y[0], nx * x[3] + ny * y[3]
    second, third = nx * x[1] + ny * y[1], nx * x[2] + ny * y[2]
    return max(max(first, last), max(second, third))
