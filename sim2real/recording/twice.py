"""Recordings that are given twice."""

from __future__ import annotations

import hashlib
from pathlib import Path


def refuse_twice(folders: list[Path]) -> None:
    """Raise ValueError for a folder that is given twice, because fitted data cannot serve as holdout."""
    seen: dict[str, Path] = {}
    for folder in folders:
        same = seen.setdefault(_digest(folder), folder)
        if same is not folder:
            copy = "" if same.resolve() == folder.resolve() else f" (it holds the same as {same})"
            raise ValueError(f"{folder} is given twice{copy}; give each recording once, for the fit or as --holdout")


def _digest(folder: Path) -> str:
    """A digest of the tables of a recording; its path if there are none."""
    tables = sorted(folder.glob("*.csv"))
    digest = hashlib.sha256()
    for path in tables:
        digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest() if tables else str(folder.resolve())
