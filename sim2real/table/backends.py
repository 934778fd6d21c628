"""Backends by name."""

from __future__ import annotations

import difflib
from typing import Any

from sim2real.table.backend import Backend

BACKENDS = ("twin",)


def make_backend(name: str, *arguments: Any, **options: Any) -> Backend:
    """The backend of this name. ValueError, in one line, for an unknown name, and where it cannot be made."""
    if name not in BACKENDS:
        near = difflib.get_close_matches(str(name), BACKENDS, n=1)
        raise ValueError(f"unknown backend '{name}'; " + (f"did you mean '{near[0]}'?" if near else "known: twin"))
    try:
        from sim2real.table.twin.twin import Twin
    except ModuleNotFoundError as error:
        if error.name != "unicorn":
            raise
        raise ValueError("the twin needs unicorn; install it with: pip install 'puckpilot[emulate]'") from None
    return Twin(*arguments, **options)
