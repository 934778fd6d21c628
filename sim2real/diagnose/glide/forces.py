"""What the simulator's effects do to a gliding puck at given places and velocities, and nothing else."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from puckpilot_env.kernel import kernel
from puckpilot_env.physics import compose
from sim2real.diagnose.glide.families import Motion
from sim2real.diagnose.problem import record_of


def accelerations(values: Mapping[str, float], motion: Motion) -> np.ndarray:
    """Accelerations (n, 2) [m/s^2] of a puck without spin by friction and all effects of a law, drag left out."""
    found = np.empty_like(motion.velocity)
    size = {"length": float(motion.size[0]), "width": float(motion.size[1])}
    _accelerations(record_of({**values, **size}), motion.t, motion.place, motion.velocity, found)
    return found


@kernel
def _accelerations(p, t, place, velocity, found):
    for i in range(len(t)):
        x, y, vx, vy = place[i, 0], place[i, 1], velocity[i, 0], velocity[i, 1]
        ax, ay = compose.acceleration(p, t[i], x, y, vx, vy, 0.0)
        brake = max(compose.friction(p, t[i], x, y, vx, vy, p.friction), 0.0)
        speed = max((vx * vx + vy * vy) ** 0.5, 1e-9)
        found[i, 0], found[i, 1] = ax - brake * vx / speed, ay - brake * vy / speed
