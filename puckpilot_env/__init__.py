"""Air hockey for learning robots: a fast simulator and registered two-player environments.

Importing this package registers every variant with PettingZoo and Gymnasium:

    import pettingzoo, puckpilot_env
    env = pettingzoo.make("parallel", "puckpilot/match-v0")
"""

from __future__ import annotations

import importlib
from functools import partial
from importlib.metadata import version
from typing import Any

import gymnasium
import pettingzoo

from puckpilot_env.adapters.parallel_vector_env import ParallelVectorEnv, parallel_vector_env
from puckpilot_env.tables import Tables
from puckpilot_env.variants import all_variants, find_variant

__all__ = ["ParallelVectorEnv", "Tables", "__version__", "all_variants", "find_variant", "parallel_vector_env"]
__version__ = version("puckpilot")


def _make(module: str, function: str, **options: Any) -> Any:
    return getattr(importlib.import_module(f"puckpilot_env.{module}"), function)(**options)


def _register() -> None:
    """Enter every id in both registries. The Gymnasium seats know players, who live a floor above: named by string."""
    for id_, variant in all_variants().items():
        if id_ not in pettingzoo.parallel_registry:
            pettingzoo.register("parallel", id_, partial(_make, variant.module, "parallel_env"))
            pettingzoo.register("aec", id_, partial(_make, variant.module, "env"))
        if id_ not in gymnasium.registry:
            gymnasium.register(
                id_,
                entry_point="baselines.gymnasium_seat:make_env",
                vector_entry_point="baselines.gymnasium_seat:make_seats",
                kwargs={"variant": id_},
            )


_register()
