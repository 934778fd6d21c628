"""What the cameras see: frames on their own clock, late, noisy, smoothly distorted, sometimes hidden, held or dropped.

Each player has a camera and a gantry of its own, hence a beam that hides the puck from it. Frame j is exposed at
`(j + frame_phase)/frame_rate` and can be used `camera_latency` later, so that at a decision the newest one is
`camera_latency + U(0, 1/frame_rate)` old. Only frames that some decision will look at are taken; a held frame shows
what the one before it showed, at the beginning of the step at the earliest.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env import random_stream
from puckpilot_env.game import mirror
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.mallet import place_at, place_now
from puckpilot_env.state import ERROR_TERMS

EXACT, ESTIMATED, HISTORY = range(3)  # kinds of sensing
LAGS = (0, 1, 2, 5, 11)  # frames back from the newest, of a history
OLDEST_LAG = 11
VELOCITY_LAG = 2  # estimated velocities are a difference over so many frames
PUCK_X, PUCK_Y, OPPONENT_X, OPPONENT_Y, SEEN = range(5)  # columns of a frame
MOST_WANTED = 62  # frames in a step; those on their way and the oldest lag are fewer


def frames_kept(sensing: int, camera_latency: float, frame_rate: float) -> int:
    """How many frames a player's history must hold: the oldest one looked at, and those still on their way."""
    if sensing == EXACT:
        return 1
    oldest = OLDEST_LAG if sensing == HISTORY else VELOCITY_LAG
    return oldest + math.ceil(camera_latency * frame_rate) + 3


@kernel
def newest_frame(table, p, time):
    """Number of the newest frame that can be used at `time` [s]."""
    return math.floor((time - p.camera_latency) * p.frame_rate - table.frame_phase + 1e-9)


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
    """Draw each player's smooth error: a quadratic surface a component, `camera_error` [m] rms over the table."""
    for k in range(2):
        camera, stream = table.cameras[k], table.streams[k]
        for term in range(ERROR_TERMS):
            camera.error_x[term] = p.camera_error * random_stream.normal(stream) / math.sqrt(2.0 * ERROR_TERMS)
            camera.error_y[term] = p.camera_error * random_stream.normal(stream) / math.sqrt(2.0 * ERROR_TERMS)


@kernel
def measure(camera, stream, p, x, y, noise):
    """A place [m] of the player's frame as its camera reports it: with the smooth error and white noise.

    The error's terms are orthonormal over the table, so each carries the same share of its rms.
    """
    u, w = 2.0 * x / p.length - 1.0, 2.0 * y / p.width - 1.0
    a, b = 1.7320508075688772 * u, 1.7320508075688772 * w
    c, d = a * b, 1.118033988749895 * (a * u * 1.7320508075688772 - 1.0)
    e = camera.error_x
    x += e[0] + e[1] * a + e[2] * b + e[3] * c + e[4] * d + noise * random_stream.normal(stream)
    e = camera.error_y
    return x, y + e[0] + e[1] * a + e[2] * b + e[3] * c + e[4] * d + noise * random_stream.normal(stream)


@kernel
def _copy_frame(frames, k, source, target):
    for c in range(frames.shape[2]):
        frames[k, target % frames.shape[1], c] = frames[k, source % frames.shape[1], c]


@kernel
def _see(camera, stream, p, frames, k, frame, last, x, y, own_x, other_x, other_y):
    """Store frame number `frame` as player `k` sees it; all places in its own frame, `own_x` its mallet's."""
    slot = frame % frames.shape[1]
    beside = abs(x - own_x)
    if beside > 0.5 * p.beam_width and random_stream.uniform(stream) >= p.dropped_frames:
        near = beside < p.puck_radius + 0.5 * p.beam_width
        x, y = measure(camera, stream, p, x, y, p.beam_noise if near else p.camera_noise)
        frames[k, slot, PUCK_X], frames[k, slot, PUCK_Y], frames[k, slot, SEEN] = x, y, 1.0
    else:
        _copy_frame(frames, k, last, frame)
        frames[k, slot, SEEN] = 0.0
    x, y = measure(camera, stream, p, other_x, other_y, p.camera_noise)
    frames[k, slot, OPPONENT_X], frames[k, slot, OPPONENT_Y] = x, y


@kernel
def repeat_frame(table, frames, frame):
    """Make frame number `frame` the same as the one before it; False, and nothing done, if that one was not taken."""
    if table.last_frame != frame - 1:
        return False
    for k in range(2):
        _copy_frame(frames, k, frame - 1, frame)
    table.last_frame = frame
    return True


@kernel
def take_frame(table, p, frames, frame, puck_x, puck_y, time):
    """Store frame number `frame` as each player's camera saw the puck and the other mallet at `time` of the plans."""
    x0, y0 = place_at(table.mallets[0], time)
    x1, y1 = place_at(table.mallets[1], time)
    last = table.last_frame
    _see(table.cameras[0], table.streams[0], p, frames, 0, frame, last, puck_x, puck_y, x0, x1, y1)
    puck_x, puck_y = mirror.place(1, puck_x, puck_y, p)
    x0, y0 = mirror.place(1, x0, y0, p)
    x1, y1 = mirror.place(1, x1, y1, p)
    _see(table.cameras[1], table.streams[1], p, frames, 1, frame, last, puck_x, puck_y, x1, x0, y0)
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
    for k in range(2):
        x, y = mirror.place(k, table.puck.x, table.puck.y, p)
        vx, vy = mirror.velocity(k, table.puck.vx, table.puck.vy)
        other_x, other_y = place_now(table.mallets[1 - k])
        other_x, other_y = mirror.place(k, other_x, other_y, p)
        for frame in range(last + 1 - frames.shape[1], last + 1):
            slot = frame % frames.shape[1]
            age = table.time - exposure(table, p, frame)
            past_x = min(max(x - vx * age, p.puck_radius), p.length - p.puck_radius)
            past_y = min(max(y - vy * age, p.puck_radius), p.width - p.puck_radius)
            frames[k, slot, PUCK_X], frames[k, slot, PUCK_Y] = past_x, past_y
            frames[k, slot, OPPONENT_X], frames[k, slot, OPPONENT_Y] = other_x, other_y
            frames[k, slot, SEEN] = 1.0
        camera = table.cameras[k]
        camera.puck_vx, camera.puck_vy = vx, vy
        camera.opponent_vx, camera.opponent_vy = 0.0, 0.0
    table.last_frame = last
