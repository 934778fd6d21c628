"""Effects, a file each, found by being here: `EFFECTS` maps the name of every file to its `EFFECT`."""

from __future__ import annotations

from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType

from puckpilot_env.effect import Effect

MODULES: dict[str, ModuleType] = {
    found.name: import_module(f"{__name__}.{found.name}")
    for found in sorted(iter_modules(__path__), key=lambda m: m.name)
}
EFFECTS: dict[str, Effect] = {name: module.EFFECT for name, module in MODULES.items()}
