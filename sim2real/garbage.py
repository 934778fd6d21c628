"""Garbage collection where time is real."""

from __future__ import annotations

import gc


def spare_what_lives() -> None:
    """Collect garbage now, and never look again at what is alive: a full collection of all that was imported takes a
    tenth of a second, and would come while something waits."""
    gc.collect()
    gc.freeze()
