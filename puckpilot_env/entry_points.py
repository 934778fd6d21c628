"""The functions by which PettingZoo makes an environment of a variant; its library is imported when one is called."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from puckpilot_env.variants import Variant

if TYPE_CHECKING:
    from pettingzoo import AECEnv, ParallelEnv


def entry_points(
    variant: Variant,
) -> tuple[Callable[..., AECEnv], Callable[..., ParallelEnv], Callable[..., AECEnv]]:
    """PettingZoo's `(env, parallel_env, raw_env)` of a variant; `parallel_env.TableEnv` describes their arguments."""

    def parallel_env(**options: Any) -> ParallelEnv:
        from puckpilot_env.adapters.parallel_env import TableEnv

        return TableEnv(variant, **options)

    def raw_env(**options: Any) -> AECEnv:
        from pettingzoo.utils.conversions import parallel_to_aec_wrapper

        return parallel_to_aec_wrapper(parallel_env(**options))

    def env(**options: Any) -> AECEnv:
        from pettingzoo.utils.wrappers import OrderEnforcingWrapper

        return OrderEnforcingWrapper(raw_env(**options))

    return env, parallel_env, raw_env
