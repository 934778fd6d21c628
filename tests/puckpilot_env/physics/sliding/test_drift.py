"""Pucks that drift over the moment at which late orders arrive: as where these are late by next to nothing, and as
where they are not late at all, which never drift."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables

HARDLY = 1e-9  # s; late, so that pucks drift, but by nothing that a place would show
TABLES, STEPS = 192, 40
FORCES = {"table_tilt": {"tilt_x": 0.08, "tilt_y": -0.05}, "table_warp": {"warp_yy": 0.3}}


def actions_of(rng: np.random.Generator) -> np.ndarray:
    """Targets all over the own half, at up to 10 V, so that mallets and pucks meet often."""
    low, high = (0.06, 0.06, 0.3, 0.3), (0.9, 0.9, 10.0, 10.0)
    return rng.uniform(low, high, (TABLES, 2, 4)).astype(np.float32)


@pytest.mark.parametrize("forces", [{}, FORCES], ids=["plain", "forces"])
def test_it_is_where_a_puck_is_that_never_drifts(forces: dict[str, dict[str, float]]) -> None:
    plain = Tables("match-v0", TABLES, seed=4, effects=forces)
    late = Tables("match-v0", TABLES, seed=4, effects={**forces, "command_delay": {"delay_s": HARDLY}})
    rng, far, moved, struck, others = np.random.default_rng(9), [], 0, 0, 0
    for _ in range(STEPS):
        late.states[:] = plain.states
        before, actions = plain.states["puck"].copy(), actions_of(rng)
        plain.step(actions)
        late.step(actions)
        ours, theirs = late.states["puck"], plain.states["puck"]
        apart = np.hypot(ours["x"] - theirs["x"], ours["y"] - theirs["y"])
        far.extend(apart.tolist())
        others += int((ours["touched"] != theirs["touched"]).any(axis=1).sum())
        moved += int((np.hypot(theirs["vx"], theirs["vy"]) > 0.05).sum())
        struck += int((before["touched"] != theirs["touched"]).any(axis=1).sum())
    assert moved > 0.4 * TABLES * STEPS and struck > 100
    assert others <= 2  # that just graze a mallet
    assert np.quantile(far, 0.99) < 1e-6 and (np.array(far) < 1e-4).mean() > 0.999
