"""What is no small plain text is refused before it costs memory or time."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from puckpilot_env.files import small_file


def test_a_text_is_read_with_and_without_a_mark(tmp_path: Path) -> None:
    for raw in (b"friction = 0.1\n", b"\xef\xbb\xbffriction = 0.1\n"):
        (tmp_path / "file.toml").write_bytes(raw)
        assert small_file.parse_toml(small_file.read_text(tmp_path / "file.toml")) == {"friction": 0.1}


def test_what_is_no_plain_file_is_not_opened(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    kinds = {Path("/dev/zero"): "a device or a pipe", tmp_path: "a folder", tmp_path / "pipe": "a device or a pipe"}
    for path, kind in kinds.items():
        with pytest.raises(ValueError, match=f"^{path}: is {kind}; expected a file$"):
            small_file.read_text(path)


def test_a_file_has_at_most_so_many_bytes(tmp_path: Path) -> None:
    path = tmp_path / "file.toml"
    path.write_text("#" * 100)
    assert small_file.read_text(path, 100) == "#" * 100
    with pytest.raises(ValueError, match=f"^{path}: has 100 bytes; expected at most 99$"):
        small_file.read_text(path, 99)


def test_bytes_that_are_no_text_are_refused(tmp_path: Path) -> None:
    (tmp_path / "file.toml").write_bytes(b"ab\xff")
    with pytest.raises(ValueError, match=r"byte 2 is not UTF-8; save the file as UTF-8 text$"):
        small_file.read_text(tmp_path / "file.toml")


@pytest.mark.parametrize("depth", [small_file.DEEPEST + 2, 100_000])
@pytest.mark.parametrize(("parse", "before"), [(small_file.parse_toml, "a = "), (small_file.parse_json, "")])
def test_deep_nesting_is_refused(parse: Callable[[str], object], before: str, depth: int) -> None:
    with pytest.raises(ValueError, match="nest too deep; expected at most 20 in each other"):
        parse(before + "[" * depth + "]" * depth)
    shallow = small_file.DEEPEST - 1
    parse(before + "[" * shallow + "]" * shallow)
