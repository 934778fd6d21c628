"""Files that are there whole or not at all: made beside their place under a hidden name, then put there."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path


def draft_of(path: Path) -> Path:
    """Where `path` is made: a hidden name beside it with its ending, always the same, so that what a killed process
    left there is written over by the next one."""
    return path.with_name(f".{path.stem}.tmp{path.suffix}")


def write_whole(path: Path, write: Callable[[Path], object]) -> Path:
    """Let `write` make the draft of `path`, put it there once it is complete, and return `path`.

    If `write` raises, what was there before stays; an OSError names `path` where it named the draft or nothing.
    """
    draft = draft_of(path)
    try:
        write(draft)
        draft.replace(path)
    except OSError as error:
        if error.filename in (None, str(draft)) and error.errno is not None:  # None: a full disk's
            raise OSError(error.errno, os.strerror(error.errno), str(path)) from None
        raise
    finally:
        draft.unlink(missing_ok=True)
    return path


def write_text_whole(path: Path, text: str) -> Path:
    """`write_whole` of a text, in UTF-8."""
    return write_whole(path, lambda draft: draft.write_text(text, encoding="utf-8"))


def check_folder(folder: Path) -> None:
    """See that files can be put into `folder`, which may have to be made, before any work is done; nothing is left.
    ValueError, in one line, if not."""
    there = next(place for place in (folder.absolute(), *folder.absolute().parents) if place.exists())
    if not there.is_dir():
        raise ValueError(f"cannot write to '{folder}': {there} is a file; give a folder")
    try:
        draft = draft_of(there / "check")
        draft.touch()
        draft.unlink()
    except OSError as error:
        raise ValueError(f"cannot write to '{folder}': {error.strerror or error}; name another folder") from None


def check_file(file: Path) -> None:
    """See that `file` can be written before any work is done. ValueError, in one line, if not."""
    if file.is_dir():
        raise ValueError(f"cannot write '{file}': it is a folder; expected a file")
    check_folder(file.absolute().parent)
