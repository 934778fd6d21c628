"""Choice of an action by search: strikes, blocks, guard positions, and random variations of the best of them."""

from __future__ import annotations

import math

import numpy as np

from baselines.planning.aim import first_strike
from baselines.planning.attack import block
from baselines.planning.geometry import crossing, fill_mallet, guard_place
from baselines.planning.rollout import HORIZON, park_opponent, value_of
from puckpilot_env.kernel import array_kernel, kernel
from puckpilot_env.physics.advance import EVENT_COLUMNS, PUCK
from puckpilot_env.physics.gantry.mallet import MALLET

MOST_CANDIDATES = 64
STRIKES, STRIKE_INTERVAL = 2, 0.08  # strikes for each shot, and s between them
LINES = (0.06, 0.15, 0.3)  # m from the goal line, at which an incoming puck is blocked
RING = 8  # target positions around the puck
# As a table has them (`game.state.TABLE`), so that `advance` is compiled once for players and tables
SCENE = np.dtype([("puck", PUCK), ("mallets", MALLET, 2)], align=True)


@array_kernel
def _propose_candidates(puck, own, last, p, weights, mallet, bounds, shots, found):
    """Write candidate actions into `found` (MOST_CANDIDATES, 4); returns how many."""
    n = 0
    found[n] = last
    n += 1
    block(puck, own, p, mallet, bounds, found[n])
    n += 1
    found[n, 0], found[n, 1] = guard_place(puck[0], puck[1], p, weights.guard)
    n += 1
    for line in LINES:
        t, y = crossing(puck[0], puck[1], puck[2], puck[3], p, line, 1.0)
        if t < math.inf:
            found[n, 0], found[n, 1] = line, y
            n += 1
    for i in range(1, n):
        found[i, 2], found[i, 3] = bounds[1, 2], bounds[1, 3]
    room = 0.5 * p.goal_width - p.puck_radius
    for w in range(shots.shape[0]):
        goal_y = 0.5 * p.width + shots[w, 1] * room
        t = 0.0
        for _ in range(STRIKES):
            t = first_strike(puck, own, p, mallet, bounds, int(shots[w, 0]), goal_y, t, HORIZON, found[n])
            if t == math.inf:
                break
            n += 1
            t += STRIKE_INTERVAL
    if puck[0] < 0.5 * p.length:
        reach = p.puck_radius + p.mallet_radius
        for i in range(RING):
            angle = 2.0 * math.pi * i / RING
            found[n, 0] = puck[0] + 2.0 * reach * math.cos(angle)
            found[n, 1] = puck[1] + 2.0 * reach * math.sin(angle)
            found[n, 2], found[n, 3] = bounds[1, 2], bounds[1, 3]
            n += 1
    return n


@kernel
def _clip(action, bounds):
    for c in range(4):
        action[c] = min(max(action[c], bounds[0, c]), bounds[1, c])


@array_kernel
def _best_candidate(puck, own, opponent, held, last, p, weights, scene, bounds, shots, variations, scratch, out):
    """Write the best candidate, improved by hill climbing over `variations`, into `out` (4,)."""
    log, found, trial = scratch
    volts = bounds[1, 3]
    best = -math.inf
    for i in range(_propose_candidates(puck, own, last, p, weights, scene.mallets[0], bounds, shots, found)):
        _clip(found[i], bounds)
        value = value_of(found[i], puck, opponent, held, p, weights, scene, log, volts)
        if value > best:
            best = value
            out[:] = found[i]
    for i in range(variations.shape[0]):
        for c in range(4):
            trial[c] = out[c] + variations[i, c]
        _clip(trial, bounds)
        value = value_of(trial, puck, opponent, held, p, weights, scene, log, volts)
        if value > best:
            best = value
            out[:] = trial


@array_kernel
def search_actions(
    pucks, owns, opponents, helds, lasts, scales, nominal, value_weights, bounds, shots, variations, scenes, actions
):
    """Write the best action found on every table into `actions` (n, 4).

    `pucks`, `owns`, `opponents` (n, 4), `helds` (n,), `scales` (n, 2, 3): as in `DecodedState`. `lasts` (n, 4): the
    previous actions. `value_weights`: (1,) record of `rollout.VALUE_WEIGHTS`. `shots` (m, 2): see `attack.Attacker`.
    `variations` (k, 4): added to the best action in turn. `scenes`: one record of SCENE, to compute with.
    """
    p, weights, scene = nominal[0], value_weights[0], scenes[0]
    park_opponent(scene.mallets[1])
    scratch = (np.zeros((0, EVENT_COLUMNS)), np.zeros((MOST_CANDIDATES, 4)), np.zeros(4))
    for i in range(pucks.shape[0]):
        puck, own = pucks[i], owns[i]
        ahead = puck[0] + HORIZON * puck[2]
        if min(puck[0], ahead) > 0.5 * p.length:
            actions[i, 0], actions[i, 1] = guard_place(puck[0], puck[1], p, weights.guard)
            actions[i, 2], actions[i, 3] = bounds[1, 2], bounds[1, 3]
            continue
        fill_mallet(scene.mallets[0], p, scales[i], own)
        _best_candidate(
            puck, own, opponents[i], helds[i], lasts[i], p, weights, scene, bounds, shots, variations, scratch,
            actions[i],
        )  # fmt: skip
