"""Garbage collection where time is real."""

from __future__ import annotations

import gc


def collect_and_freeze() -> None:
    """Collect garbage now, and keep all objects that are alive out of later collections: a full one of all that was
    imported takes a tenth of a second, and would come while something waits."""
    gc.collect()
    gc.freeze()
