"""Tables of the simulator whose puck a network of residuals corrects at the end of every step."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from puckpilot_env.batch.one_thread import one_thread
from puckpilot_env.game import sensing
from puckpilot_env.residual import kernels
from puckpilot_env.residual.network import INPUTS, PERIOD, Residual
from puckpilot_env.tables import Tables
from puckpilot_env.variants import Variant


def refuse_uncorrectable(variant: Variant) -> None:
    """ValueError, in one line, for a variant whose steps no network of residuals can correct."""
    if variant.rules()[0]["sensing"] != sensing.EXACT or abs(variant.period - PERIOD) > 1e-9:
        raise ValueError(
            f"a network of residuals cannot correct {variant.id} with steps of {variant.period:g} s; "
            f"expected a variant that shows the state itself, such as match-v0, and {PERIOD:g} s"
        )


class ResidualTables(Tables):
    """`Tables` with corrections where play simply went on: not where an episode ended, the puck was put anywhere, is in
    a goal mouth, or the opponent's mallet may have struck it, for no network is fitted there.

    What a step meant (goals, possession, rewards) is as the simulator had it; a corrected puck stays on the table, on
    its side of the middle line and out of the mallets. Beside the arrays of `Tables`, overwritten by every `step`:

    - `inputs` (n, 18) float32: what the network saw, see `network.INPUTS`; `went_on` (n,) bool: where it corrects.
    """

    def __init__(self, variant: Variant | str, tables: int, residual: Residual, **options: Any) -> None:
        """See `Tables`. ValueError, in one line, for a variant that shows camera frames, or has other steps."""
        super().__init__(variant, tables, **options)
        try:
            refuse_uncorrectable(self.variant)
        except ValueError:
            self.close()
            raise
        self.residual = residual
        self.inputs = np.zeros((len(self), len(INPUTS)), np.float32)
        self.went_on = np.zeros(len(self), np.bool_)
        self._touched = np.zeros(len(self), np.int64)

    @one_thread
    def step(self, actions: ArrayLike) -> None:
        """See `Tables.step`."""
        kernels.see_before(self.states, self.params, self.inputs, self._touched)
        super().step(actions)
        kernels.see_after(self.states, self.params, np.ascontiguousarray(actions, np.float32), self.inputs)
        kernels.correct_range(
            self.states, self.params, self.nominal, self._rules, self._frames, self.observation_bounds, self.inputs,
            self._touched, self.terminated, self.truncated, self.residual(self.inputs), self.went_on,
            self.observations,
        )  # fmt: skip
