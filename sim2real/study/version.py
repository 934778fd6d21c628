"""The version of the code that kept results come from, so that results of other versions are not reused."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

OF_STUDIES = ("sim2real", "puckpilot_env")  # the diagnosis, its physics, and the independent table
OF_GAMES = ("agents", "baselines", "firmware", "puckpilot_env", "sim2real")  # the players and the board's program too
ENDINGS = (".py", ".elf", ".npz")  # code, the board's program, trained players


def code_version(root: Path, folders: Sequence[str]) -> str:
    """A short digest of the code in `folders` of the checkout `root`."""
    digest = hashlib.sha256()
    for folder in folders:
        for file in sorted(one for one in (root / folder).rglob("*") if one.suffix in ENDINGS):
            text = file.read_bytes()
            digest.update(f"{file.relative_to(root).as_posix()} {len(text)}\n".encode() + text)
    return digest.hexdigest()[:12]
