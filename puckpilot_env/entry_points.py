"""The functions by which PettingZoo makes an environment of a variant; its library is imported when one is called."""

from __future__ import annotations

import importlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from puckpilot_env.variants import Variant

if TYPE_CHECKING:
    from pettingzoo import AECEnv, ParallelEnv

TWO_SEATS = "sim2real.table.game.two_seats"  # of a package above this one, so loaded only where a backend is named


def entry_points(
    variant: Variant,
) -> tuple[Callable[..., AECEnv], Callable[..., ParallelEnv], Callable[..., AECEnv]]:
    """PettingZoo's `(env, parallel_env, raw_env)` of a variant; `parallel_env.TableEnv` describes their arguments, and
    with a `backend`, a table outside the simulator, `sim2real.table.game.two_seats.TwoSeats` does."""

    def parallel_env(*, backend: str | None = None, **options: Any) -> ParallelEnv:
        from puckpilot_env.adapters.parallel_env import TableEnv

        if backend is not None:
            return importlib.import_module(TWO_SEATS).make_two_seats(variant, backend, **options)
        return TableEnv(variant, **options)

    def raw_env(**options: Any) -> AECEnv:
        from pettingzoo.utils.conversions import parallel_to_aec_wrapper

        return parallel_to_aec_wrapper(parallel_env(**options))

    def env(**options: Any) -> AECEnv:
        from pettingzoo.utils.wrappers import OrderEnforcingWrapper

        return OrderEnforcingWrapper(raw_env(**options))

    return env, parallel_env, raw_env
