"""Files of arrays that someone hands over: read without executing anything, and refused before they cost memory."""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.files.small_file import check_regular


def read_arrays(path: Path, most: int) -> dict[str, NDArray[Any]]:
    """The arrays of an npz by name. ValueError for a device or a pipe, for one that unfolds to more than `most` bytes,
    and for pickled objects; OSError where it cannot be read. A broken file raises what its readers do: any exception.
    """
    check_regular(path, most)
    with zipfile.ZipFile(path) as members:
        if sum(member.file_size for member in members.infolist()) > most:
            raise ValueError(f"it unfolds to more than {most} bytes")
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}
