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
from collections.abc import Iterator
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


@pytest.fixture(scope="module")
def packages(tmp_path_factory) -> Path:
    """The repository's packages copied to a folder."""
    folder = tmp_path_factory.mktemp("copy")
    for name in ("puckpilot_env", "baselines", "agents", "sim2real"):
        shutil.copytree(REPOSITORY / name, folder / name, ignore=shutil.ignore_patterns("__pycache__"))
    return folder


@pytest.fixture
def copied(packages, tmp_path, monkeypatch) -> Iterator[Path]:
    """The copied packages, as they were after each test, and a cache of its own."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    yield packages
    for path in EDITED:
        shutil.copy(REPOSITORY / path, packages / path)
    EDITED.clear()


EDITED: list[Path] = []


def edit(root: Path, path: Path) -> None:
    """Write something more into a file of the copy."""
    EDITED.append(path)
    with (root / path).open("a") as file:
        file.write("# edited\n")


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


@pytest.fixture(scope="module")
def unedited(packages, tmp_path_factory) -> dict[str, str]:
    """The name of each package's folder in the cache, before any edit of the copy."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        module = load(packages)
        assert module.cache_folder_of("baselines") == module.CACHE_FOLDER
        return {name: module.cache_folder_of(name).name for name in ("baselines", "agents", "sim2real")}


def test_each_package_above_has_a_folder_of_its_own(unedited):
    assert len(set(unedited.values())) == 3


@pytest.mark.parametrize("path", COMPILED + READ_BY_KERNELS, ids=str)
def test_an_edit_of_a_kernel_starts_a_fresh_folder(copied, unedited, tmp_path, path):
    edit(copied, path)
    after = cache_folder(copied)
    assert after.name != unedited["baselines"] and after.parent == tmp_path / "cache" / "puckpilot"


def test_an_edit_that_is_taken_back_leaves_what_was_compiled(copied, unedited):
    assert cache_folder(copied).name == unedited["baselines"]


@pytest.mark.parametrize("path", [*ABOVE, Path("sim2real/vision/track/blobs.py")], ids=str)
def test_an_edit_above_the_players_starts_a_fresh_folder_for_its_package_alone(copied, unedited, path):
    edit(copied, path)
    after = load(copied)
    changed = {name for name, folder in unedited.items() if after.cache_folder_of(name).name != folder}
    assert changed == {path.parts[0]}


def test_an_edit_of_the_simulator_starts_a_fresh_folder_for_all(copied, unedited):
    edit(copied, Path("puckpilot_env/game/state.py"))
    after = load(copied)
    assert all(after.cache_folder_of(name).name != folder for name, folder in unedited.items())


@pytest.mark.parametrize(
    "name", ["rendering/drawing", "documentation/page", "adapters/parallel_env", "commands/bench", "checks/walk"]
)
def test_other_edits_keep_what_was_compiled(copied, unedited, name):
    edit(copied, Path(f"puckpilot_env/{name}.py"))
    assert cache_folder(copied).name == unedited["baselines"]


def test_another_numba_starts_a_fresh_folder(copied, monkeypatch):
    before = cache_folder(copied)
    monkeypatch.setattr(kernel.numba, "__version__", "0.0.1")
    assert cache_folder(copied) != before


def test_unwritable_cache_falls_back_to_a_temporary_folder(copied, tmp_path, monkeypatch):
    """A file in the way is what no one can write into, not even root."""
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
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
