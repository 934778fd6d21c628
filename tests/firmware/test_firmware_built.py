"""What is committed is what its sources make: both sides' messages, and the program that is flashed, byte for byte."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from firmware import ELF, FOLDER, QEMU_ELF
from firmware.definition import Field, read_protocol
from firmware.generate import stale
from tests.sim2real.emulate.built import need_compiler

FLASH, RAM = 16384, 6144  # bytes that it may take


def test_messages_follow_from_the_definition():
    assert stale(read_protocol()) == []


def test_the_programs_rebuild_byte_for_byte(tmp_path: Path):
    need_compiler()
    copy = tmp_path / "elsewhere"
    shutil.copytree(FOLDER, copy, ignore=shutil.ignore_patterns("build", "*.elf", "__pycache__"))
    printed = subprocess.run(["make", "-C", str(copy), "f103", "qemu"], capture_output=True, text=True, check=True)
    assert "flash" in printed.stdout
    for elf in (ELF, QEMU_ELF):
        assert (copy / elf.name).read_bytes() == elf.read_bytes()


def test_the_program_fits():
    """By its own headers: what is loaded into flash, and what lies in RAM without the stack."""
    data = ELF.read_bytes()
    start, count = int.from_bytes(data[28:32], "little"), int.from_bytes(data[44:46], "little")
    flash = ram = 0
    for at in range(start, start + 32 * count, 32):
        kind, _, where, _, stored, held = (int.from_bytes(data[at + k : at + k + 4], "little") for k in range(0, 24, 4))
        if kind == 1:
            flash += stored
            ram += held if where >= 0x20000000 else 0
    assert 4000 < flash <= FLASH and 1000 < ram <= RAM


@pytest.mark.parametrize("wrong", [{"type": "f64"}, {"type": "u8", "low": 1}, {"type": "u8", "count": 0}])
def test_a_field_that_cannot_be_is_refused(wrong: dict):
    with pytest.raises(ValueError, match="field speed"):
        Field("speed", **wrong)


def test_the_schema_changes_with_what_a_receiver_relies_on(tmp_path: Path):
    text = (FOLDER / "protocol.toml").read_text()
    schemas = set()
    for before, after in (
        ("", ""), ('"apply", type = "u32"', '"apply", type = "i32"'), ("high = 60.0", "high = 61.0"),
        ('name = "rest"', 'name = "slack"'), ('name = "traj"', 'name = "plan"'), ('name = "refusal"', 'name = "no"'),
        ('["ESTOP", "the host said stop"],', ""), ("version = [1, 1]", "version = [2, 0]"),
    ):  # fmt: skip
        assert before in text
        (tmp_path / "protocol.toml").write_text(text.replace(before, after, 1))
        schemas.add(read_protocol(tmp_path / "protocol.toml").schema)
    assert len(schemas) == 8
    (tmp_path / "protocol.toml").write_text(text.replace("the host said stop", "stop, said the host"))
    assert read_protocol(tmp_path / "protocol.toml").schema == read_protocol().schema


@pytest.mark.parametrize("ids", [("id = 12", "id = 11"), ("id = 12", "id = 13"), ("id = 1\n", "id = 0\n")])
def test_ids_have_no_gap_by_which_the_firmware_would_miss_a_layout(tmp_path: Path, ids: tuple[str, str]):
    text = (FOLDER / "protocol.toml").read_text()
    assert ids[0] in text
    (tmp_path / "protocol.toml").write_text(text.replace(*ids, 1))
    with pytest.raises(ValueError, match="expected 1, 2, 3 and so on"):
        read_protocol(tmp_path / "protocol.toml")
