"""All regimes with residuals of their own, in pipeline order: every folder here that has a `regime.py`."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path

from sim2real.diagnose.regimes.base import Regime


def _in_order(regimes: list[Regime]) -> dict[str, Regime]:
    """Order each regime after those that it depends on; alphabetical otherwise."""
    waiting, ordered = sorted(regimes, key=lambda one: one.name), {}
    while waiting:
        ready = next(one for one in waiting if set(one.after) <= ordered.keys())
        waiting.remove(ready)
        ordered[ready.name] = ready
    return ordered


REGIMES: dict[str, Regime] = _in_order(
    [
        import_module(f"{__package__}.{path.parent.name}.regime").REGIME
        for path in Path(__file__).parent.glob("*/regime.py")
    ]
)
