"""The floors hold: who imports whom, what start-up loads, that everything public is explained, and the linters."""

from __future__ import annotations

import ast
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.places import ROOT

PACKAGES = ("puckpilot_env", "baselines", "agents", "sim2real", "firmware", "results")
PHYSICS, GAME = "puckpilot_env/physics", "puckpilot_env/game"
# folder: what the modules in it may not import, not even inside functions
FORBIDDEN = {
    "puckpilot_env": ("baselines", "agents", "sim2real", "puckpilot", "tests"),
    "baselines": ("agents", "sim2real", "puckpilot", "tests"),
    "agents": ("sim2real", "puckpilot", "tests"),
    "firmware": ("agents", "baselines", "sim2real", "puckpilot", "tests"),
    "sim2real": ("agents", "puckpilot", "tests"),
    "results": ("agents", "baselines", "sim2real", "firmware", "puckpilot", "tests"),
    "sim2real/vision/calibrate": ("sim2real.vision.track", "sim2real.vision.trial"),
    "sim2real/vision/track": ("sim2real.vision.trial",),
    "tests/mujoco_table": (
        "puckpilot_env",
        "baselines",
        "agents",
        "firmware",
        "puckpilot",
        "sim2real.diagnose",
        "sim2real.segmentation",
        "sim2real.compare",
        "sim2real.recording",
    ),
}
# folder: all that the modules in it may import
ALLOWED = {
    PHYSICS: (
        "__future__", "collections", "functools", "importlib", "math", "numpy", "pkgutil", "types", "typing",
        "puckpilot_env.effect", "puckpilot_env.kernel", "puckpilot_env.physics",
    ),
    GAME: (
        "__future__", "dataclasses", "math", "numpy", "puckpilot_env.kernel", "puckpilot_env.physics",
        "puckpilot_env.game", "puckpilot_env.game.state", "puckpilot_env.game.random_stream",
    ),
}  # fmt: skip
MOST_FILES = 15  # in a folder, but for those of which every file is one of a kind
SOURCES = (".py", ".c", ".h")
REGISTRIES = ("puckpilot_env/physics/effects", "sim2real/commands")
HEAVY = ("torch", "cv2", "serial", "matplotlib", "rich", "PIL")
SCIPY = ("scipy.linalg", "scipy.optimize", "scipy.stats", "scipy.sparse", "scipy.spatial", "scipy.special")
# library: the one package whose modules may import it at the top
HOMES = {"torch": "agents", "cv2": "sim2real", "serial": "sim2real", "unicorn": "sim2real"}
DOCUMENTED_INSIDE = (ast.FunctionDef, ast.AsyncFunctionDef, ast.ClassDef)


def _modules(folder: str) -> list[Path]:
    return sorted((ROOT / folder).rglob("*.py"))


def _imports(path: Path, nodes: Iterator[ast.AST] | None = None) -> list[str]:
    """Dotted names that a file imports: `from a import b` is both `a` and `a.b`, relative ones made absolute."""
    found = []
    for node in nodes or ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            package = path.relative_to(ROOT).parts[:-1]
            base = ".".join(package[: len(package) - node.level + 1]) if node.level else ""
            module = ".".join(part for part in (base, node.module) if part)
            found += [module, *(f"{module}.{alias.name}" for alias in node.names)]
    return found


def _at_start_up(tree: ast.AST) -> Iterator[ast.AST]:
    """What runs when a module is imported: everything outside functions and `if TYPE_CHECKING`."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda):
            continue
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            continue
        yield node
        yield from _at_start_up(node)


def _inside(name: str, roots: tuple[str, ...]) -> bool:
    return any(name == root or name.startswith(f"{root}.") for root in roots)


def _leads_to(name: str, roots: tuple[str, ...]) -> bool:
    """Whether `name` is in one of `roots`, or a package above one, of which a listed name follows it in `_imports`."""
    return _inside(name, roots) or any(root.startswith(f"{name}.") for root in roots)


@pytest.mark.slow
@pytest.mark.parametrize("folder", FORBIDDEN)
def test_no_floor_imports_from_above_it(folder: str) -> None:
    modules = [path for path in _modules(folder) if not path.name.startswith("test_")]
    wrong = [(str(m), name) for m in modules for name in _imports(m) if _inside(name, FORBIDDEN[folder])]
    assert modules and not wrong


@pytest.mark.parametrize("folder", ALLOWED)
def test_physics_and_game_import_only_what_is_below_them(folder: str) -> None:
    assert _modules(folder)
    wrong = [(str(m), name) for m in _modules(folder) for name in _imports(m) if not _leads_to(name, ALLOWED[folder])]
    assert not wrong


def test_no_folder_is_crowded() -> None:
    tracked = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    counts = Counter(str(Path(name).parent) for name in tracked.splitlines() if Path(name).suffix in SOURCES)
    crowded = {folder: n for folder, n in counts.items() if n > MOST_FILES and folder not in REGISTRIES}
    assert len(counts) > 20 and not crowded


@pytest.mark.slow
@pytest.mark.parametrize("library", HOMES)
def test_a_heavy_library_is_imported_at_the_top_only_in_its_home(library: str) -> None:
    wrong = []
    for package in PACKAGES:
        for path in _modules(package):
            tree = ast.parse(path.read_text(encoding="utf-8"))
            if package != HOMES[library] and _inside_any(_imports(path, _at_start_up(tree)), library):
                wrong.append(str(path))
    assert not wrong


def _inside_any(names: list[str], root: str) -> bool:
    return any(_inside(name, (root,)) for name in names)


def _whole_imports() -> dict[str, set[str]]:
    """For each module of the product, those that it imports when it is loaded, or would for its types alone."""
    paths = [path for folder in PACKAGES for path in _modules(folder) if path.name != "__init__.py"]
    names = {".".join(path.relative_to(ROOT).with_suffix("").parts): path for path in paths}
    return {
        name: {one for one in _imports(path, _outside_functions(path)) if one in names} for name, path in names.items()
    }


def _outside_functions(path: Path) -> Iterator[ast.AST]:
    waiting: list[ast.AST] = [ast.parse(path.read_text(encoding="utf-8"))]
    while waiting:
        node = waiting.pop()
        yield node
        waiting += [one for one in ast.iter_child_nodes(node) if not isinstance(one, ast.FunctionDef | ast.Lambda)]


def _circle(imports: dict[str, set[str]]) -> list[str]:
    """Modules that import each other, in a circle; none where there is none."""
    left = dict(imports)
    while free := [name for name, needed in left.items() if not needed & (left.keys() - {name})]:
        for name in free:
            del left[name]
    if not left:
        return []
    way = [next(iter(left))]
    while len(set(way)) == len(way):
        way.append(sorted(left[way[-1]] & left.keys() - {way[-1]})[0])
    return way[way.index(way[-1]) :]


def test_no_modules_import_each_other_in_a_circle() -> None:
    """Nor for their types alone, under TYPE_CHECKING."""
    assert _circle({"a": {"b"}, "b": {"c"}, "c": {"b"}, "d": set()}) == ["b", "c", "b"]
    assert _circle({"a": {"b"}, "b": {"c"}, "c": set()}) == []
    imports = _whole_imports()
    assert "sim2real.diagnose.engine.problem" in imports["sim2real.diagnose.engine.forward_selection"]
    assert _circle(imports) == []


def test_the_readers_of_imports_see_what_they_should(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys.modules[__name__], "ROOT", tmp_path)
    path = tmp_path / "house" / "room.py"
    path.parent.mkdir()
    path.write_text(
        "from typing import TYPE_CHECKING\nfrom . import door\nif TYPE_CHECKING:\n    import torch\n"
        "class A:\n    import cv2\n    def f(self):\n        from PIL import Image\n"
    )
    everything = _imports(path)
    assert {"house", "house.door", "torch", "cv2", "PIL", "PIL.Image"} <= set(everything)
    at_start = _imports(path, _at_start_up(ast.parse(path.read_text())))
    assert "cv2" in at_start and "torch" not in at_start and "PIL" not in at_start


def test_nothing_heavy_is_loaded_with_the_simulator() -> None:
    """scipy's own root is loaded by numba; its parts, which cost, are not."""
    code = "import sys, puckpilot_env; print(*sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    loaded = set(out.split())
    assert "puckpilot_env.tables" in loaded
    assert not loaded & {*HEAVY, *SCIPY}


@pytest.mark.parametrize("package", PACKAGES)
def test_everything_public_has_a_docstring(package: str) -> None:
    bare = []
    for path in _modules(package):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        if path.name != "__init__.py" and not ast.get_docstring(tree):
            bare.append(str(path.relative_to(ROOT)))
        bare += [f"{path.relative_to(ROOT)}: {name}" for name in _undocumented(tree.body)]
    assert not bare


def _undocumented(nodes: list[ast.stmt]) -> Iterator[str]:
    """Public functions, classes and methods without a docstring; a method of a private class is not public."""
    for node in nodes:
        if isinstance(node, DOCUMENTED_INSIDE) and node.name[0] != "_" and not _sets_a_property(node):
            if not ast.get_docstring(node):
                yield node.name
            if isinstance(node, ast.ClassDef):
                yield from (f"{node.name}.{name}" for name in _undocumented(node.body))


def _sets_a_property(node: ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef) -> bool:
    return any(isinstance(one, ast.Attribute) and one.attr == "setter" for one in node.decorator_list)


def _run(*words: str) -> None:
    done = subprocess.run([sys.executable, "-m", *words], cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, f"{' '.join(words)}:\n{done.stdout}{done.stderr}"


def test_ruff_finds_nothing() -> None:
    _run("ruff", "check", ".")


def test_everything_is_formatted() -> None:
    _run("ruff", "format", "--check", ".")


@pytest.mark.slow
def test_types_fit() -> None:
    """Those of the product, by pyrefly: a tenth of pyright's time."""
    _run("pyrefly", "check", "--python-interpreter-path", sys.executable, "--output-format", "min-text")


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.parametrize("what", [("puckpilot.py", *PACKAGES, "docs/hooks"), ("tests",)], ids=["product", "tests"])
def test_types_fit_by_pyright_too(what: tuple[str, ...]) -> None:
    """The tests are as many lines as the product again, and take as long."""
    _run("pyright", "--pythonpath", sys.executable, *what)
