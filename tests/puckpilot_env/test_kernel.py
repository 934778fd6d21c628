"""The kernel cache: another folder after any edit of a kernel, the same after any other; none needed to work."""

from __future__ import annotations

import ast
import importlib
import importlib.util
import os
import re
import shutil
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from puckpilot_env import kernel

pytestmark = pytest.mark.slow

REPOSITORY = Path(kernel.__file__).parents[1]


def compiled_in(*folders: str) -> list[Path]:
    """The files in which kernels are defined."""
    return sorted(
        path.relative_to(REPOSITORY)
        for folder in folders
        for path in (REPOSITORY / folder).rglob("*.py")
        if re.search(r"^@(array_|inlined_|calling_)?kernel", path.read_text(), re.MULTILINE)
    )


COMPILED, ABOVE = compiled_in("puckpilot_env", "baselines"), compiled_in("agents", "sim2real")
READ_BY_KERNELS = [Path("puckpilot_env") / f"{name}.py" for name in ("kernel", "parameters", "game/state")]


@pytest.fixture
def copied(tmp_path, monkeypatch):
    """The repository's packages copied to a folder, and a cache of their own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    for name in ("puckpilot_env", "baselines", "agents", "sim2real"):
        shutil.copytree(REPOSITORY / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    return tmp_path


def cache_folder(root: Path) -> Path:
    """Where a fresh import of the copy's `kernel.py` would keep what it compiles."""
    return load(root).CACHE_FOLDER


def load(root: Path) -> Any:
    spec = importlib.util.spec_from_file_location("kernel_copy", root / "puckpilot_env" / "kernel.py")
    assert spec and spec.loader
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_kernels_were_found():
    names = {path.name for path in COMPILED}
    assert {"glide.py", "advance.py", "reward.py", "step.py", "kernels.py", "random_stream.py"} <= names
    assert any(path.parts[0] == "baselines" for path in COMPILED)


@pytest.mark.parametrize("path", COMPILED + READ_BY_KERNELS, ids=str)
def test_an_edit_of_a_kernel_starts_a_fresh_folder(copied, path):
    before = cache_folder(copied)
    assert cache_folder(copied) == before
    source = (copied / path).read_text()
    (copied / path).write_text(source + "# edited\n")
    after = cache_folder(copied)
    assert after != before and after.parent == before.parent == copied / "cache" / "puckpilot"
    (copied / path).write_text(source)
    assert cache_folder(copied) == before


@pytest.mark.parametrize("path", [*ABOVE, Path("sim2real/vision/track/blobs.py")], ids=str)
def test_an_edit_above_the_players_starts_a_fresh_folder_for_its_package_alone(copied, path):
    package, other = path.parts[0], "agents" if path.parts[0] == "sim2real" else "sim2real"
    before = load(copied)
    folders = {name: before.cache_folder_of(name) for name in (package, other, "baselines")}
    assert len(set(folders.values())) == 3 and folders["baselines"] == before.CACHE_FOLDER
    with (copied / path).open("a") as file:
        file.write("# edited\n")
    after = load(copied)
    assert after.cache_folder_of(package) != folders[package]
    assert all(after.cache_folder_of(name) == folders[name] for name in (other, "baselines"))
    with (copied / "puckpilot_env" / "game" / "state.py").open("a") as file:
        file.write("# edited\n")
    assert load(copied).cache_folder_of(other) != folders[other]


@pytest.mark.parametrize(
    "name", ["rendering/drawing", "documentation/page", "adapters/parallel_env", "commands/bench", "checks/walk"]
)
def test_other_edits_keep_what_was_compiled(copied, name):
    before = cache_folder(copied)
    with (copied / "puckpilot_env" / f"{name}.py").open("a") as file:
        file.write("# edited\n")
    assert cache_folder(copied) == before


def test_another_numba_starts_a_fresh_folder(copied, monkeypatch):
    before = cache_folder(copied)
    monkeypatch.setattr(kernel.numba, "__version__", "0.0.1")
    assert cache_folder(copied) != before


def test_unwritable_cache_falls_back_to_a_temporary_folder(copied, monkeypatch):
    """A file in the way is what no one can write into, not even root."""
    (copied / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(copied / "file"))
    folder = cache_folder(copied)
    assert folder.is_dir() and folder.name.startswith("puckpilot-kernels-")
    assert cache_folder(copied) != folder  # shared by no two processes
    folder.rmdir()


def test_no_home_folder_falls_back_too(copied, monkeypatch):
    """A container's user may be unknown to the system."""
    monkeypatch.delenv("XDG_CACHE_HOME")

    def unknown() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.setattr(Path, "home", unknown)
    assert cache_folder(copied).name.startswith("puckpilot-kernels-")


def test_old_folders_are_swept(copied):
    folder = cache_folder(copied)
    others = {name: folder.parent / name for name in ("old", "recent", "strange")}
    for other in others.values():
        other.mkdir()
    for name, days in (("old", 31), ("recent", 29)):
        (others[name] / "used").touch()
        os.utime(others[name] / "used", (time.time() - 86400 * days, time.time() - 86400 * days))
    cache_folder(copied)
    assert {path.name for path in folder.parent.iterdir()} == {folder.name, "recent", "strange"}


def test_announces_compilation_once(copied, capsys):
    module = load(copied)
    module.announce_compilation("step_range")
    assert capsys.readouterr().err.startswith("puckpilot: compiling the simulator")
    (module.CACHE_FOLDER / "sub").mkdir()
    (module.CACHE_FOLDER / "sub" / "batch.step_range-55.py311.nbi").touch()
    module.announce_compilation("step_range")
    assert capsys.readouterr().err == ""


def first_of_each(rows, out):
    for i in range(rows.shape[0]):
        row = rows[i]
        out[i] = row[0]


@pytest.mark.parametrize("decorator, counts", [("kernel", False), ("inlined_kernel", False), ("array_kernel", True)])
def test_only_kernels_that_make_arrays_count_references(copied, decorator, counts):
    compiled = getattr(load(copied), decorator)(first_of_each)
    out = np.zeros(3)
    compiled(np.arange(6.0).reshape(3, 2), out)
    assert out.tolist() == [0.0, 2.0, 4.0]
    (code,) = compiled.inspect_llvm().values()
    assert ("NRT_" in code) == counts


def makes_records(path: Path) -> list[str]:
    """The kernels of a file that make an array of records."""
    module, found = importlib.import_module(".".join(path.with_suffix("").parts)), []
    for function in ast.walk(ast.parse((REPOSITORY / path).read_text())):
        if isinstance(function, ast.FunctionDef) and any("kernel" in ast.dump(one) for one in function.decorator_list):
            calls = [node for node in ast.walk(function) if isinstance(node, ast.Call)]
            words = [
                ast.unparse(word) for call in calls if ast.unparse(call.func).startswith("np.") for word in call.args
            ]
            if any(isinstance(getattr(module, word, None), np.dtype) for word in words):
                found.append(f"{path}: {function.name}")
    return found


@pytest.mark.parametrize("path", COMPILED + ABOVE, ids=str)
def test_no_kernel_makes_records(path):
    """What is taken out of an array of records does not hold the array, which is freed after its last use by name."""
    assert makes_records(path) == []


def test_the_running_folder_is_that_of_these_sources():
    assert sys.modules["puckpilot_env.kernel"].CACHE_FOLDER == kernel.CACHE_FOLDER
    assert kernel.CACHE_FOLDER.name == load(REPOSITORY).CACHE_FOLDER.name


def test_hooks_that_were_made_inside_a_function_have_names_of_their_own() -> None:
    """In cached kernels of two processes one name would stand for two functions."""
    from puckpilot_env.physics import compose

    found, todo = (
        {},
        [compose.acceleration, compose.friction, compose.edge, compose.stride, compose.angle, compose.shares],
    )
    while todo:
        function = todo.pop().py_func
        parts = [cell.cell_contents for cell in function.__closure__ or ()]
        todo += parts
        found.setdefault((function.__module__, function.__qualname__), set()).add(function)
    assert len(found) > 40 and all(len(same) == 1 for same in found.values())
