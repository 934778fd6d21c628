"""What the camera sees: frames on its own clock, late, noisy, smoothly distorted, sometimes hidden, held or dropped.

One camera hangs over the table, and both players get its frames. Between it and the table move the beams of both
gantries, and either may hide the puck. Frame j is exposed at
`(j + frame_phase)/frame_rate`, give or take its `frame_jitter` but within the step, and can be used `camera_latency`
later, so that at a decision the newest one is `camera_latency + U(0, 1/frame_rate)` old. Only frames that some
decision will look at are taken; a held frame shows what the one before it showed, at the beginning of the step at the
earliest.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.game import mirror, random_stream
from puckpilot_env.game.state import ERROR_TERMS
from puckpilot_env.kernel import inlined_kernel, kernel
from puckpilot_env.physics import compose
from puckpilot_env.physics.gantry.mallet import place_at, place_now
from puckpilot_env.physics.gantry.places import places_at_both

EXACT, ESTIMATED, HISTORY = range(3)  # kinds of sensing
LAGS = (0, 1, 2, 5, 11)  # frames back from the newest, of a history
OLDEST_LAG = LAGS[-1]
VELOCITY_LAG = 2  # estimated velocities are a difference over so many frames
_ROOT_12, _HALF_ROOT_5 = math.sqrt(12.0), 0.5 * math.sqrt(5.0)
MOST_WANTED = 62  # frames in a step; those on their way and the oldest lag are fewer
SHOT_COLUMNS = 7  # of what a frame shows: time in the step [s], places of the puck and of both mallets [m]


def frames_kept(sensing: int, camera_latency: float, frame_rate: float) -> int:
    """How many frames a history holds: back to the oldest one looked at, and those still on their way.

    A power of two, so that `slot` needs no division.
    """
    if sensing == EXACT:
        return 1
    oldest = OLDEST_LAG if sensing == HISTORY else VELOCITY_LAG
    return 1 << (oldest + math.ceil(camera_latency * frame_rate) + 2).bit_length()


@kernel
def slot(frames, frame):
    """Where in a history of `frames_kept` frames number `frame` is."""
    return frame & (frames.size - 1)


@kernel
def newest_frame(table, p, time):
    """Number of the newest frame that can be used at `time` [s]."""
    return math.floor((time - p.camera_latency) * p.frame_rate - table.frame_phase + 1e-9)


@kernel
def mean_delay(p):
    """How old the newest frame is at a decision, on average [s]."""
    return p.camera_latency + 0.5 / p.frame_rate


def first_delay(frame_phase: np.ndarray, p: np.ndarray) -> np.ndarray:
    """How old the newest frame is at an episode's first decision [s]; `newest_frame` at time 0, for many tables."""
    newest = np.floor(-p["camera_latency"] * p["frame_rate"] - frame_phase + 1e-9)
    return -(newest + frame_phase) / p["frame_rate"]


@kernel
def exposure(table, p, frame):
    """When frame number `frame` is exposed [s]."""
    return (frame + table.frame_phase) / p.frame_rate


@kernel
def frames_exposed(table, p):
    """Number of the first frame that is exposed after now."""
    return math.floor(table.time * p.frame_rate - table.frame_phase) + 1


@kernel
def _bit(frame, first, last):
    return 1 << (frame - first) if first <= frame <= last else 0


@kernel
def wanted_frames(table, p, sensing, period):
    """`(first, bits)`: which frames exposed in this step some decision will look at; bit i stands for `first + i`.

    No decision looks further back than the next one, so `first` skips what even that one will not need, and the bits
    are enough for a step of any length.
    """
    last = math.floor((table.time + period) * p.frame_rate - table.frame_phase)
    step = table.steps + 1
    newest = newest_frame(table, p, step * period)
    oldest = OLDEST_LAG if sensing == HISTORY else VELOCITY_LAG
    first = max(frames_exposed(table, p), newest - oldest)
    wanted = 0
    while newest - oldest <= last:
        if sensing == HISTORY:
            for lag in LAGS:
                wanted |= _bit(newest - lag, first, last)
        else:
            wanted |= _bit(newest, first, last) | _bit(newest - VELOCITY_LAG, first, last)
        step += 1
        newest = newest_frame(table, p, step * period)
    return first, wanted


@kernel
def draw_camera_error(table, p):
    """Draw the camera's smooth error: a quadratic surface a component, `camera_error` [m] rms over the table.

    The error of its map, which the effects say, is the same in every episode and added to it.
    """
    scale = p.camera_error / math.sqrt(2.0 * ERROR_TERMS)
    for term in range(ERROR_TERMS):
        x, y = random_stream.normal_pair(table.stream)
        turned = mirror.TURNED_ERROR[term] if table.puck.turned == 1 else 1.0
        table.camera.error_x[term], table.camera.error_y[term] = turned * scale * x, turned * scale * y
    xx, xy, yx, yy = compose.camera_map(p)
    flat = mirror.TURNED_ERROR[0] if table.puck.turned == 1 else 1.0
    _lay_out(table.camera.error_x, p, xx, xy, flat)
    _lay_out(table.camera.error_y, p, yx, yy, flat)


@kernel
def _lay_out(error, p, along_x, along_y, turned):
    """Make weights of terms that are orthonormal over the table, so that each carries the same share of the rms, the
    coefficients of `smooth_error`; and add an error that grows by `along_x` and `along_y` for each metre of x and y."""
    steep_x, steep_y = _ROOT_12 / p.length, _ROOT_12 / p.width
    error[0] += turned * 0.5 * (along_x * p.length + along_y * p.width) - _HALF_ROOT_5 * error[4]
    error[1] = error[1] * steep_x + along_x
    error[2] = error[2] * steep_y + along_y
    error[3] *= steep_x * steep_y
    error[4] *= _HALF_ROOT_5 * steep_x * steep_x


@inlined_kernel
def smooth_error(e, x, y):
    """A component of the smooth error [m] at (x, y) [m] from the table's middle; e: its coefficients [m, 1, 1/m]."""
    return (e[0] + e[2] * y) + x * (e[1] + (e[3] * y + e[4] * x))


@inlined_kernel
def measure(table, p, x, y, noise, measured):
    """Write the place [m] as the camera reports `(x, y)` into `measured`: with the smooth error and white noise."""
    from_middle_x, from_middle_y = x - 0.5 * p.length, y - 0.5 * p.width
    dx, dy = random_stream.normal_pair(table.stream)
    dx, dy = mirror.velocity(table.puck.turned, noise * dx, noise * dy)
    measured.x = x + (smooth_error(table.camera.error_x, from_middle_x, from_middle_y) + dx)
    measured.y = y + (smooth_error(table.camera.error_y, from_middle_x, from_middle_y) + dy)


@kernel
def repeat_frame(table, frames, frame):
    """Make frame number `frame` the same as the one before it; False, and nothing done, if that one was not taken."""
    if table.last_frame != frame - 1:
        return False
    frames[slot(frames, frame)] = frames[slot(frames, frame - 1)]
    table.last_frame = frame
    return True


@inlined_kernel
def shoot_mallets(mallets, film):
    """Write both mallets' places into shots, (m, SHOT_COLUMNS) in the order of their times."""
    for k in range(2):
        at = 3 + 2 * k
        for i in range(0, film.shape[0] - 1, 2):
            film[i, at], film[i, at + 1], film[i + 1, at], film[i + 1, at + 1] = places_at_both(
                mallets[k], film[i, 0], film[i + 1, 0]
            )
        if film.shape[0] & 1:
            film[-1, at], film[-1, at + 1] = place_at(mallets[k], film[-1, 0])


@inlined_kernel
def take_frame(table, p, frames, frame, shot):
    """Store frame number `frame` as the camera saw a shot (SHOT_COLUMNS).

    Where the puck is not seen, its place is the one in the frame before.
    """
    taken, last = frames[slot(frames, frame)], frames[slot(frames, table.last_frame)]
    puck_x, puck_y = shot[1], shot[2]
    beside = min(abs(puck_x - shot[3]), abs(puck_x - shot[5]))  # the nearer beam
    if beside > 0.5 * p.beam_width and random_stream.uniform(table.stream) >= p.dropped_frames:
        near = beside < p.puck_radius + 0.5 * p.beam_width
        measure(table, p, puck_x, puck_y, p.beam_noise if near else p.camera_noise, taken.puck)
        taken.seen = 1.0
    else:
        taken.puck.x, taken.puck.y = last.puck.x, last.puck.y
        taken.seen = 0.0
    for i in range(2):
        k = i ^ table.puck.turned  # a turned table draws for the same mallet first
        measure(table, p, shot[3 + 2 * k], shot[4 + 2 * k], p.camera_noise, taken.mallets[k])
    table.last_frame = frame


@kernel
def begin_frames(table, p, frames):
    """Fill the history with the puck coming straight to where it is now, as clean frames; draw the smooth error."""
    draw_camera_error(table, p)
    fill_frames(table, p, frames)


@kernel
def fill_frames(table, p, frames):
    """Fill the history as if the puck had come straight to where it is, and the mallets had stood still."""
    last = frames_exposed(table, p) - 1
    puck = table.puck
    for number in range(last + 1 - frames.size, last + 1):
        frame = frames[slot(frames, number)]
        age = table.time - exposure(table, p, number)
        frame.puck.x = min(max(puck.x - puck.vx * age, p.puck_radius), p.length - p.puck_radius)
        frame.puck.y = min(max(puck.y - puck.vy * age, p.puck_radius), p.width - p.puck_radius)
        frame.seen = 1.0
        for k in range(2):
            frame.mallets[k].x, frame.mallets[k].y = place_now(table.mallets[k])
    table.camera.puck_vx, table.camera.puck_vy = puck.vx, puck.vy
    table.last_frame = last
