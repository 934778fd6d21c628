"""A table that can be checked by hand: straight free paths, one wall restitution, and a camera with faults."""

from dataclasses import dataclass

import numpy as np

from sim2real.recording.folder import Recording, Stream

LENGTH, WIDTH, RADIUS, MALLET = 2.0, 1.0, 0.03, 0.05
RATE = 150.0
META = {
    "format": "puckpilot-recording/1",
    "table": {"length_m": LENGTH, "width_m": WIDTH, "goal_width_m": 0.001},  # practically none
    "puck": {"radius_m": RADIUS},
    "mallet": {"radius_m": MALLET},
    "camera": {"rate_hz": RATE, "position_std_m": None},
}


@dataclass(frozen=True)
class Truth:
    """Times, walls and normal speeds of the contacts, and the faulty frames."""

    contacts: list[tuple[float, str, float]]
    wild: np.ndarray
    held: np.ndarray


def bouncing(launches, seconds: float, restitution: float = 0.8, deceleration: float = 0.0):
    """Return positions (frames, 2) at RATE, and the contacts; each launch (x, y, vx, vy) lasts `seconds`."""
    step = 1.0 / RATE
    path, contacts = [], []
    for number, (x, y, vx, vy) in enumerate(launches):
        p, v, now = np.array([x, y]), np.array([vx, vy]), number * seconds
        for k in range(round(seconds * RATE)):
            path.append(p.copy())
            now = number * seconds + k * step
            p, v = _advance(p, v, now, step, restitution, contacts)
            speed = np.linalg.norm(v)
            v = v * max(0.0, 1 - deceleration * step / max(speed, 1e-9))
    return np.array(path), contacts


def _advance(p, v, now, left, restitution, contacts):
    limits = (("x", RADIUS, LENGTH - RADIUS), ("y", RADIUS, WIDTH - RADIUS))
    while True:
        first, axis, wall = left, None, ""
        for k, (name, low, high) in enumerate(limits):
            if v[k]:
                wait = ((low if v[k] < 0 else high) - p[k]) / v[k]
                if 0 <= wait < first:
                    first, axis, wall = wait, k, name + ("0" if v[k] < 0 else "1")
        p = p + v * first
        if axis is None:
            return p, v
        now, left = now + first, left - first
        contacts.append((now, wall, abs(v[axis])))
        v = v * np.where(np.arange(2) == axis, -restitution, 1.0)


def recorded(path, contacts, rng, noise=0.0005, drops=0.0, held=0.0, wild=0.0, jitter=0.0):
    """Return the recording of `path` by a camera with `noise` [m], and its ground truth."""
    t = np.arange(len(path)) / RATE
    seen = path + rng.normal(0, noise, path.shape)
    was_wild = rng.random(len(t)) < wild
    angle = rng.uniform(0, 2 * np.pi, len(t))
    far = rng.uniform(0.02, 0.1, len(t))[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    seen[was_wild] += far[was_wild]
    was_held = rng.random(len(t)) < held
    was_held[0] = False
    for k in np.flatnonzero(was_held):
        seen[k] = seen[k - 1]
    blank = (rng.random(len(t)) < drops) & ~np.append(was_held[1:], False)
    seen[blank] = np.nan
    unseen = np.full(len(t), np.nan)
    stamps = t + rng.uniform(0, jitter, len(t))
    columns = {"t": stamps, "puck_x": seen[:, 0], "puck_y": seen[:, 1], "opponent_x": unseen, "opponent_y": unseen}
    return Recording("synthetic", META, Stream(columns)), Truth(contacts, was_wild & ~blank, was_held & ~blank)
