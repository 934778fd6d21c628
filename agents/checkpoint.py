"""Everything that a run needs to go on as if it had never stopped, in one file that runs no code when it is read."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from puckpilot_env.tables import Tables
from puckpilot_env.whole_file import write_whole

FORMAT = "puckpilot-checkpoint-1"
ARRAYS = ("states", "params", "frames", "observations")  # of a snapshot


def save_checkpoint(path: Path, contents: Mapping[str, Any]) -> Path:
    """Write tensors, numbers, texts, lists and dicts to `path`, whole or not at all. OSError where it has no room."""
    whole = io.BytesIO()  # torch itself tells of a full disk in a way of its own
    torch.save({"format": FORMAT, **contents}, whole)
    return write_whole(path, lambda draft: draft.write_bytes(whole.getvalue()))


def load_checkpoint(path: Path) -> dict[str, Any]:
    """What was saved. ValueError, in one line, for a file that is no checkpoint, is cut short, or holds more."""
    try:
        contents = torch.load(path, weights_only=True, map_location="cpu")
    except FileNotFoundError:
        raise ValueError(f"no checkpoint at {path}") from None
    except Exception as error:  # a broken file breaks torch's readers in many ways
        raise ValueError(
            f"{path} is no checkpoint, or is cut short ({type(error).__name__}); a new run can begin with the player "
            "beside it, by --start"
        ) from None
    if not isinstance(contents, dict) or contents.pop("format", None) != FORMAT:
        raise ValueError(f"{path} is not of the format {FORMAT}")
    return contents


def tables_as_tensors(tables: Tables) -> dict[str, Any]:
    """All tables at an instant, random streams included, as bytes, and whose they are."""
    snapshot = tables.snapshot()
    return {"variant": tables.variant.id} | {name: torch.from_numpy(_bytes(getattr(snapshot, name))) for name in ARRAYS}


def restore_tables(tables: Tables, kept: Mapping[str, Any]) -> None:
    """Put `tables_as_tensors` back. ValueError where they are of other tables."""
    variant = kept.get("variant", tables.variant.id)  # checkpoints of before did not say
    if variant != tables.variant.id:
        raise ValueError(f"the checkpoint is of {variant}; this run plays {tables.variant.id}")
    now = tables.snapshot()
    arrays = {}
    for name in ARRAYS:
        like = getattr(now, name)
        data = kept[name].numpy()
        if data.size != like.nbytes:
            raise ValueError(f"the checkpoint's {name} have {data.size} bytes; these tables have {like.nbytes}")
        arrays[name] = np.frombuffer(data.tobytes(), like.dtype).reshape(like.shape)
    tables.restore(replace(now, **arrays))


def _bytes(array: np.ndarray) -> np.ndarray:
    return np.frombuffer(array.tobytes(), np.uint8).copy()
