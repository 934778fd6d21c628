"""The documentation builds strictly, with no network: no warning, every page there, every formula shown."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import puckpilot
from puckpilot_env.documentation.page import FOLDER
from puckpilot_env.parameters import TABLE
from puckpilot_env.physics.effects import EFFECTS
from tests.places import ROOT

pytestmark = pytest.mark.slow

LINK = re.compile(r"\]\((?!https?:)([^)#\s]+)")
SOURCE = re.compile(r"`((?:agents|baselines|docs|firmware|puckpilot_env|sim2real|tests)/[\w./]+)`")
RECORD = re.compile(r"^class (\w+Numbers)", re.MULTILINE)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site as MkDocs writes it; a warning is an error."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert "WARNING -" not in done.stderr, done.stderr
    return folder


def test_every_page_is_written(site: Path) -> None:
    pages = [path for path in (ROOT / "docs").rglob("*.md")]
    written = [site / path.relative_to(ROOT / "docs").with_suffix(".html") for path in pages]
    assert len(pages) > 20 and all(path.is_file() for path in written)


def test_reference_names_every_command_parameter_effect_and_environment(site: Path) -> None:
    text = {path.stem: path.read_text(encoding="utf-8") for path in (site / "reference").glob("*.html")}
    assert [name for name in puckpilot.COMMANDS if f'id="{name.replace(" ", "-")}"' not in text["commands"]] == []
    assert [name for name in EFFECTS if f'id="{name}"' not in text["effects"]] == []
    of_effects = {row.name for effect in EFFECTS.values() for row in effect.rows.values()}
    baseline = [row.name for row in TABLE if row.name not in of_effects]
    assert [name for name in baseline if f"<code>{name}</code>" not in text["parameters"]] == []
    records = [
        name for path in (ROOT / "sim2real").rglob("tuned.py") for name in RECORD.findall(path.read_text("utf-8"))
    ]
    assert len(records) > 15 and [name for name in records if f'id="{name.lower()}"' not in text["thresholds"]] == []
    environments = {path.stem for path in (site / "reference" / "environments").glob("*.html")}
    assert {path.stem for path in FOLDER.glob("*_v*.md")} <= environments


def test_formulas_are_mathml_and_no_page_asks_the_network(site: Path) -> None:
    pages = {path: path.read_text(encoding="utf-8") for path in site.rglob("*.html")}
    assert any("<math" in text for text in pages.values())
    for path, text in pages.items():
        assert "arithmatex" not in text, f"{path}: a formula was left as it was"
        assert 'src="http' not in text and '<link rel="stylesheet" href="http' not in text, path


@pytest.mark.parametrize("name", ["README.md", "CONTRIBUTING.md", "firmware/README.md"])
def test_links_of_pages_beside_the_site_lead_somewhere(name: str) -> None:
    page = ROOT / name
    links = LINK.findall(page.read_text(encoding="utf-8"))
    assert links and [link for link in links if not (page.parent / link).exists()] == []


def test_files_that_pages_name_are_there() -> None:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *(ROOT / "docs").rglob("*.md")]
    named = {(page.name, path) for page in pages for path in SOURCE.findall(page.read_text(encoding="utf-8"))}
    assert len(named) > 100 and sorted(pair for pair in named if not (ROOT / pair[1]).exists()) == []
