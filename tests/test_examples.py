"""Python of the README and the guides runs as it stands, with less training, and prints what is written beside it."""

from __future__ import annotations

import re
from importlib.util import find_spec
from pathlib import Path

import pytest

from tests.places import ROOT

pytestmark = pytest.mark.slow

BLOCK = re.compile(r"```python\n(.*?)```", re.DOTALL)
PRINTED = re.compile(r"^print\(.*\)  # (.*)$", re.MULTILINE)
LESS = {"100_000": "512"}  # steps of training
NEEDS = {"import minari": "minari"}  # which brings jax along, and which the suite does not install
BEFORE = {"torch.onnx.export": "import torch\nmodule = torch.nn.Linear(21, 4)\n"}  # what a block's text speaks of


def _examples() -> dict[str, str]:
    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    return {
        f"{page.stem}-{k}": code
        for page in pages
        for k, code in enumerate(BLOCK.findall(page.read_text(encoding="utf-8")), 1)
    }


EXAMPLES = _examples()


def test_there_are_examples() -> None:
    assert len(EXAMPLES) > 10 and "README-1" in EXAMPLES


@pytest.mark.parametrize("name", EXAMPLES)
def test_it_runs(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    code = EXAMPLES[name]
    expected = [line for line in PRINTED.findall(code) if "..." not in line]
    for words, package in NEEDS.items():
        if words in code and find_spec(package) is None:
            pytest.skip(f"{name} needs {package}, which is not installed")
    for much, little in LESS.items():
        code = code.replace(much, little)
    for words, before in BEFORE.items():
        code = before + code if code.startswith(words) else code
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MINARI_DATASETS_PATH", str(tmp_path))
    (tmp_path / "sim2real").symlink_to(ROOT / "sim2real")
    exec(compile(code, name, "exec"), {"__name__": name})
    printed = capsys.readouterr().out.splitlines()
    assert [line for line in expected if line not in printed] == []
