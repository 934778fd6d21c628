"""Games that the reference table can follow: gentle actions, and the plans that come of them."""

from __future__ import annotations

import numpy as np

from puckpilot_env import Tables
from puckpilot_env.batch.motion import mallet_motion
from sim2real.study.independent_table.physics.volts import Plan
from tests.puckpilot_env.physics.table_driver import areas, plan_both, record

PERIOD = 0.1


def gentle(tables: Tables, rng: np.random.Generator) -> np.ndarray:
    """Actions (n, 2, 4) that keep clear of the rails, which no reference has."""
    actions = np.empty((len(tables), 2, 4), np.float32)
    actions[..., 0], actions[..., 1] = rng.uniform((0.3, 0.3), (0.7, 0.7), (len(tables), 2, 2)).transpose(2, 0, 1)
    actions[..., 2:] = rng.uniform(2.0, 5.0, (len(tables), 2, 2))
    return actions


def asked_for(tables: Tables, actions: np.ndarray) -> list[Plan]:
    """The plans of the first table's mallets from where their motors are, as the players ask for them."""
    p, state = record(), tables.states.copy().view(np.recarray)[0]
    is_rigid = not (tables.params["belt_hz"][0] or tables.params["backlash_gap"][0])
    gantries = state.mallets if is_rigid else state.motors
    requests = actions[0].astype(float)
    requests[1, :2] = (p.length, p.width) - requests[1, :2]
    plan_both(gantries, requests, areas(p), p.max_voltage)
    return [(m.x.volts, m.y.volts, m.x.t1, m.y.t1, m.x.t2, m.y.t2) for m in gantries]


def played(tables: Tables, steps: int) -> tuple[np.ndarray, list[list]]:
    """Gentle steps on a single table: its mallets' motion (steps + 1, 2, 4), and the plans of either mallet."""
    rng, motion, plans = np.random.default_rng(5), [mallet_motion(tables.states)[0]], [[], []]
    for step in range(steps):
        actions = gentle(tables, rng)
        for k, plan in enumerate(asked_for(tables, actions)):
            plans[k].append((PERIOD * step, plan))
        tables.step(actions)
        motion.append(mallet_motion(tables.states)[0])
    return np.array(motion), plans
