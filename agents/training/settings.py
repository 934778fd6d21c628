"""The settings of a training run, as `run.json` keeps them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from agents.training.preset import Preset, read_preset


@dataclass(frozen=True)
class Settings:
    """What a run trains.

    - `variant`: id; `seed`: of everything random; `threads`: to learn on; `preset`: how to train.
    - `effects`: parameters of an effects file; `draws`: contents of a draws file; None for neither.
    - `against`: the only opponent, of a best response; None for a league.
    - `start`: a run's folder or a policy's file whose networks it starts with; None for untrained ones.
    - `device`: torch's name for where the networks are.
    - `residual`: a file of a network that corrects the simulator's steps, see `residual.network`; None for none.
    """

    variant: str
    seed: int
    threads: int
    preset: Preset
    effects: Mapping[str, float] | None = None
    draws: Mapping[str, Any] | None = None
    against: str | None = None
    start: str | None = None
    device: str = "cpu"
    residual: str | None = None

    def as_dict(self) -> dict[str, Any]:
        """The settings as JSON can hold them; the preset as its text."""
        return {**vars(self), "preset": self.preset.text}

    @classmethod
    def from_dict(cls, saved: Mapping[str, Any]) -> Settings:
        """The settings of an `as_dict`. ValueError, in one line, for anything else."""
        try:
            values: dict[str, Any] = {**saved, "preset": read_preset(saved["preset"], "of the run")}
            return cls(**values)
        except (KeyError, TypeError) as error:
            raise ValueError(f"these are no settings of a run: {error}") from None
