"""The version of the code that a study's answers come from, so that answers of other versions are not reused."""

from __future__ import annotations

import hashlib
from pathlib import Path

FOLDERS = ("sim2real", "puckpilot_env")  # the diagnosis, its physics, and the independent table


def code_version(root: Path) -> str:
    """A short digest of the code that makes cases, diagnoses and scores in the checkout `root`."""
    digest = hashlib.sha256()
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*.py")):
            text = file.read_bytes()
            digest.update(f"{file.relative_to(root).as_posix()} {len(text)}\n".encode() + text)
    return digest.hexdigest()[:12]
