"""An ONNX model as a player: whatever library made it, by ONNX's reference evaluator.

The model's one input is (n, d) float32, an agent's observations; its one output (n, 4), the actions: target x, y [m]
and voltages x, y [V]. The metadata `columns`, names with commas between them, says which columns of the observation it
takes; without it, all of them in their order. Nothing but the model's file is read, and no code comes with it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baselines.player import Player, Seat
from puckpilot_env.files.small_file import check_regular

MOST_BYTES = 1 << 28
EXPECTED = "expected an ONNX model of one input (n, d), the observations, and one output (n, 4), the actions"


class OnnxPlayer(Player):
    """Plays the model of a file. ValueError, in one line, for a file that is none, or does not fit the seat."""

    def __init__(self, file: Path, seat: Seat) -> None:
        self.seat = seat
        self._file = file
        self._evaluator, columns = _load(file)
        names = columns or list(seat.columns)
        if missing := [name for name in names if name not in seat.columns]:
            raise ValueError(f"{file} takes '{missing[0]}', which {seat.variant} does not show")
        self._index = np.array([seat.columns[name] for name in names], np.int64)
        self.act(np.zeros((seat.tables, len(seat.columns)), np.float32))  # so that what does not fit is refused now

    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """Actions (n, 4) float32, inside the seat's bounds, for observations (n, d) float32."""
        given = {self._evaluator.input_names[0]: np.ascontiguousarray(observation[:, self._index], np.float32)}
        try:
            (found,) = self._evaluator.run(None, given)
            actions = np.asarray(found, np.float32)
        except MemoryError:
            raise
        except Exception as error:  # of the evaluator or numpy: a model may be wrong in any way
            words = " ".join(str(error).split())[:120]
            raise ValueError(f"{self._file} cannot be run ({words}); {EXPECTED}") from None
        count = len(observation)
        if actions.shape != (count, 4) or not np.isfinite(actions).all():
            raise ValueError(f"{self._file} gives {actions.shape} for {count} observations, or no numbers; {EXPECTED}")
        low, high = self.seat.action_bounds
        return np.clip(actions, low, high)


def _load(file: Path) -> tuple[Any, list[str] | None]:
    """The evaluator of a model, and the columns that it names, None for no names."""
    try:
        import onnx
        from onnx.reference import ReferenceEvaluator
    except ImportError:
        raise ValueError(f"{file} needs onnx; install it with: pip install 'puckpilot[train]'") from None
    try:
        check_regular(file, MOST_BYTES)
        model = onnx.load(str(file), load_external_data=False)
        onnx.checker.check_model(model)
        evaluator = ReferenceEvaluator(model)
    except FileNotFoundError:
        raise ValueError(f"no policy at {file}") from None
    except MemoryError:
        raise
    except Exception as error:  # of protobuf, the checker or the evaluator
        raise ValueError(f"{file} cannot be read ({type(error).__name__}); {EXPECTED}") from None
    if len(evaluator.input_names) != 1 or len(evaluator.output_names) != 1:
        names = ", ".join(map(str, [*evaluator.input_names, *evaluator.output_names]))
        raise ValueError(f"{file} has {names}; {EXPECTED}")
    named = {one.key: one.value for one in model.metadata_props}.get("columns")
    return evaluator, named.split(",") if named else None
