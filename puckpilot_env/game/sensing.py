"""What the cameras see: frames on their own clock, late, noisy, smoothly distorted, sometimes hidden, held or dropped.

Each player has a camera and a gantry of its own, hence a beam that hides the puck from it. Frame j is exposed at
`(j + frame_phase)/frame_rate` and can be used `camera_latency` later, so that at a decision the newest one is
`camera_latency + U(0, 1/frame_rate)` old. Only frames that some decision will look at are taken.
"""

from __future__ import annotations

import math

from puckpilot_env import random_stream
from puckpilot_env.game import mirror
from puckpilot_env.kernel import kernel
from puckpilot_env.physics import contact
from puckpilot_env.state import ERROR_TERMS, FRAMES_KEPT

EXACT, ESTIMATED, HISTORY = range(3)  # kinds of sensing
LAGS = (0, 1, 2, 5, 11)  # frames back from the newest, of a history
OLDEST_LAG = 11
VELOCITY_LAG = 2  # estimated velocities are a difference over so many frames
PUCK_X, PUCK_Y, OPPONENT_X, OPPONENT_Y, SEEN = range(5)  # columns of a frame


@kernel
def newest_frame(table, p, time):
    """Number of the newest frame that can be used at `time` [s]."""
    return math.floor((time - p.camera_latency) * p.frame_rate - table.frame_phase + 1e-9)


@kernel
def exposure(table, p, frame):
    """When frame number `frame` is exposed [s]."""
    return (frame + table.frame_phase) / p.frame_rate


@kernel
def frames_exposed(table, p):
    """Number of the first frame that is exposed after now."""
    return math.floor(table.time * p.frame_rate - table.frame_phase) + 1


@kernel
def is_looked_at(table, p, frame, sensing, step, period):
    """Whether a decision at the end of step `step` (0, 1, ..) or later looks at this frame."""
    for later in range(step, step + 64):
        lag = newest_frame(table, p, (later + 1) * period) - frame
        if lag > OLDEST_LAG:
            return False
        if sensing == HISTORY:
            if lag == 0 or lag == 1 or lag == 2 or lag == 5 or lag == 11:
                return True
        elif lag == 0 or lag == VELOCITY_LAG:
            return True
    return False


@kernel
def draw_camera_error(table, p):
    """Draw each player's smooth error: a quadratic surface a component, `camera_error` [m] rms over the table."""
    for k in range(2):
        for c in range(2):
            for term in range(ERROR_TERMS):
                z = random_stream.normal_pair(table, k)[0]
                table.camera_error[k, c, term] = p.camera_error * z / math.sqrt(2.0 * ERROR_TERMS)


@kernel
def smooth_error(table, k, c, u, w):
    """The error [m] of component `c` at `(u, w)` in -1..1 over the table; its terms are orthonormal there."""
    e = table.camera_error
    return (
        e[k, c, 0]
        + 1.7320508 * (e[k, c, 1] * u + e[k, c, 2] * w)
        + 3.0 * e[k, c, 3] * u * w
        + 1.1180340 * e[k, c, 4] * (3.0 * u * u - 1.0)
    )


@kernel
def measure(table, p, k, x, y, noise):
    """A place [m] of player `k`'s frame as its camera reports it."""
    u, w = 2.0 * x / p.length - 1.0, 2.0 * y / p.width - 1.0
    noise_x, noise_y = random_stream.normal_pair(table, k)
    return x + smooth_error(table, k, 0, u, w) + noise * noise_x, y + smooth_error(table, k, 1, u, w) + noise * noise_y


@kernel
def _copy_frame(frames, k, source, target):
    for c in range(frames.shape[2]):
        frames[k, target % FRAMES_KEPT, c] = frames[k, source % FRAMES_KEPT, c]


@kernel
def take_frame(table, p, frames, frame, puck_x, puck_y, path, time):
    """Store frame number `frame` as each player's camera saw the puck and the other mallet at `time` of the plans."""
    gantry = table.gantry
    for k in range(2):
        chance = random_stream.uniform(table, k)
        if chance < p.held_frames:
            _copy_frame(frames, k, table.last_frame, frame)
            continue
        slot = frame % FRAMES_KEPT
        x, y = mirror.place(k, puck_x, puck_y, p)
        own = contact.mallet_motion(path, gantry, k, time)
        other = contact.mallet_motion(path, gantry, 1 - k, time)
        beam, _ = mirror.place(k, own[0], own[1], p)
        other_x, other_y = mirror.place(k, other[0], other[1], p)
        beside = abs(x - beam)
        near = beside < p.puck_radius + 0.5 * p.beam_width
        seen = beside > 0.5 * p.beam_width and chance < 1.0 - p.dropped_frames
        if seen:
            x, y = measure(table, p, k, x, y, p.beam_noise if near else p.camera_noise)
            frames[k, slot, PUCK_X], frames[k, slot, PUCK_Y], frames[k, slot, SEEN] = x, y, 1.0
        else:
            _copy_frame(frames, k, table.last_frame, frame)
            frames[k, slot, SEEN] = 0.0
        other_x, other_y = measure(table, p, k, other_x, other_y, p.camera_noise)
        frames[k, slot, OPPONENT_X], frames[k, slot, OPPONENT_Y] = other_x, other_y
    table.last_frame = frame


@kernel
def begin_frames(table, p, frames):
    """Fill the history with the puck coming straight to where it is now, as clean frames; draw the smooth error."""
    draw_camera_error(table, p)
    fill_frames(table, p, frames)


@kernel
def fill_frames(table, p, frames):
    """Fill the history as if the puck had come straight to where it is, and the mallets had stood still."""
    newest = newest_frame(table, p, table.time)
    last = frames_exposed(table, p) - 1
    for k in range(2):
        x, y = mirror.place(k, table.puck[0], table.puck[1], p)
        vx, vy = mirror.velocity(k, table.puck[2], table.puck[3])
        modes = table.modes
        other = 1 - k
        other_x, other_y = mirror.place(
            k, modes[other, 0, 0] + modes[other, 0, 1] + modes[other, 0, 2],
            modes[other, 1, 0] + modes[other, 1, 1] + modes[other, 1, 2], p,
        )  # fmt: skip
        for frame in range(newest - OLDEST_LAG, last + 1):
            slot = frame % FRAMES_KEPT
            age = table.time - exposure(table, p, frame)
            past_x = min(max(x - vx * age, p.puck_radius), p.length - p.puck_radius)
            past_y = min(max(y - vy * age, p.puck_radius), p.width - p.puck_radius)
            frames[k, slot, PUCK_X], frames[k, slot, PUCK_Y] = past_x, past_y
            frames[k, slot, OPPONENT_X], frames[k, slot, OPPONENT_Y] = other_x, other_y
            frames[k, slot, SEEN] = 1.0
        table.seen_velocity[k, 0], table.seen_velocity[k, 1] = vx, vy
        table.seen_velocity[k, 2] = table.seen_velocity[k, 3] = 0.0
    table.last_frame = last
