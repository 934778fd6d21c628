"""The pooled proof of several regimes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim2real.diagnose.result.result import Proof


def pooled(proofs: Sequence[Proof]) -> Proof | None:
    """Return the rms over all launches of the proofs, None if there is none."""
    if not proofs:
        return None
    pieces = sum(one.pieces for one in proofs)
    before, after, floor = (
        float(np.sqrt(sum(one.pieces * getattr(one, name) ** 2 for one in proofs) / max(pieces, 1)))
        for name in ("before_m", "after_m", "floor_m")
    )
    return Proof(before, after, floor, pieces)
