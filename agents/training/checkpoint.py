"""The file format of checkpoints: tensors, numbers and texts. Reading one executes no code."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from puckpilot_env.files.whole_file import write_whole
from puckpilot_env.tables import Tables

FORMAT = "puckpilot-checkpoint-1"
ARRAYS = ("states", "params", "frames", "observations")  # fields of `Snapshot`


def save_checkpoint(path: Path, contents: Mapping[str, Any]) -> Path:
    """Write tensors, numbers, texts, lists and dicts to `path`, completely or not at all; returns `path`.

    OSError where the disk is full.
    """
    whole = io.BytesIO()  # torch.save to a file would not raise OSError for a full disk
    torch.save({"format": FORMAT, **contents}, whole)
    return write_whole(path, lambda draft: draft.write_bytes(whole.getvalue()))


def load_checkpoint(path: Path) -> dict[str, Any]:
    """The contents given to `save_checkpoint`.

    ValueError, in one line, for a file that is no checkpoint, is truncated, or holds objects of other types.
    """
    try:
        contents = torch.load(path, weights_only=True, map_location="cpu")
    except FileNotFoundError:
        raise ValueError(f"no checkpoint at {path}") from None
    except Exception as error:  # a broken file breaks torch's readers in many ways
        raise ValueError(
            f"{path} is not a checkpoint, or is truncated ({type(error).__name__}); a new run can begin with the "
            "player beside it, by --start"
        ) from None
    if not isinstance(contents, dict) or contents.pop("format", None) != FORMAT:
        raise ValueError(f"{path} is not of the format {FORMAT}")
    return contents


def tables_as_tensors(tables: Tables) -> dict[str, Any]:
    """The state of all tables, random streams included, as byte tensors by name, and the variant's id."""
    snapshot = tables.snapshot()
    return {"variant": tables.variant.id} | {name: torch.from_numpy(_bytes(getattr(snapshot, name))) for name in ARRAYS}


def restore_tables(tables: Tables, saved: Mapping[str, Any]) -> None:
    """Restore what `tables_as_tensors` gave. ValueError if it is of other tables."""
    variant = saved.get("variant", tables.variant.id)  # older checkpoints lack it
    if variant != tables.variant.id:
        raise ValueError(f"the checkpoint is of {variant}; this run plays {tables.variant.id}")
    now = tables.snapshot()
    arrays: dict[str, Any] = {}
    for name in ARRAYS:
        like = getattr(now, name)
        data = saved[name].numpy()
        if data.size != like.nbytes:
            raise ValueError(f"the checkpoint's {name} have {data.size} bytes; these tables have {like.nbytes}")
        arrays[name] = np.frombuffer(data.tobytes(), like.dtype).reshape(like.shape)
    tables.restore(replace(now, **arrays))


def _bytes(array: np.ndarray) -> np.ndarray:
    return np.frombuffer(array.tobytes(), np.uint8).copy()
