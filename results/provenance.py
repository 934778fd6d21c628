"""Of which code and on which machine a run was made."""

from __future__ import annotations

import os
import platform
import subprocess
from importlib.metadata import version
from pathlib import Path

LIBRARIES = ("numpy", "scipy", "numba")
NO_CODE = (":!results", ":!docs", ":!*.md")  # what may be changed without a commit while runs are made


def machine() -> dict[str, str | int]:
    """Processor, number of cores, system, and the versions of Python and of the libraries that compute."""
    described: dict[str, str | int] = {
        "cpu": _processor(),
        "cores": os.cpu_count() or 1,
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
    }
    return described | {name: version(name) for name in LIBRARIES}


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown"


def commit(root: Path) -> str:
    """The commit that is checked out. ValueError where there is none, or where code was changed since."""
    head = _git(root, "rev-parse", "HEAD")
    if head.returncode:
        raise ValueError(f"{root} is no clone of the repository; an output names the commit that it is of")
    if changed := changed_code(root, "HEAD"):
        words = "commit it first, since an output names the commit that it is of"
        raise ValueError(f"{changed[0]} is not committed; {words}")
    return head.stdout.strip()


def changed_code(root: Path, since: str) -> list[str]:
    """The files of code that are not as they were in the commit `since`, or that git does not know."""
    changed = _git(root, "diff", "--name-only", since, "--", ".", *NO_CODE)
    unknown = _git(root, "ls-files", "--others", "--exclude-standard", "--", ".", *NO_CODE)
    return [*changed.stdout.splitlines(), *unknown.stdout.splitlines()]


def in_history(root: Path, commit: str) -> bool:
    """Whether a commit is HEAD or one before it. True also where git cannot know, outside a whole
    clone."""
    shallow = _git(root, "rev-parse", "--is-shallow-repository")
    if shallow.returncode or shallow.stdout.strip() != "false":
        return True
    return _git(root, "merge-base", "--is-ancestor", commit, "HEAD").returncode == 0


def _git(root: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(["git", *words], cwd=root, capture_output=True, text=True)
