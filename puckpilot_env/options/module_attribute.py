"""What a caller names as "module:attribute": a class or function of a package of the caller's own."""

from __future__ import annotations

import importlib
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

NAMED = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*(\.[^\W\d]\w*)*")


def is_module_attribute(name: str) -> bool:
    """Whether `name` is of the form "module:attribute", both perhaps with dots."""
    return NAMED.fullmatch(name) is not None


def import_callable(name: str, makes: str) -> Callable[..., Any]:
    """Import "module:attribute", which runs the module's code; the folder where a command is called is looked in, too.

    ValueError, in one line, where there is none, or it cannot be called; `makes`: what is expected of it, in words.
    """
    module, _, attribute = name.partition(":")
    here = str(Path.cwd())
    if here not in sys.path:  # an installed command does not look in the folder where it is called
        sys.path.insert(0, here)
    try:
        found = importlib.import_module(module)
        for part in attribute.split("."):
            found = getattr(found, part)
    except Exception as error:  # the module's own code may fail in any way
        words = " ".join(f"{type(error).__name__}: {error}".split())
        raise ValueError(f"cannot import '{name}': {words}") from error
    if not callable(found):
        raise ValueError(f"'{name}' is a {type(found).__name__}; expected something that makes {makes}")
    return found
