"""MkDocs hook: the page of all tuned numbers of the diagnosis, written from their records."""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

from sim2real import compare, diagnose, identify, recording, segmentation, statistics
from sim2real.statistics.tuned import listed
from sim2real.table import latency

PACKAGES = (recording, segmentation, statistics, compare, diagnose, identify, latency)
HEAD = """\
# Thresholds

Written from the records of tuned numbers.

Numbers that were chosen, not measured or derived: each with its unit (1 where there is none), what goes wrong if it is
much smaller or larger, and how it was set. A stage has one record, used as `RECORD.name`.

"""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the page."""
    files.append(File.generated(config, "reference/thresholds.md", content=write_thresholds()))
    return files


def write_thresholds() -> str:
    """A section for each record, a row for each number."""
    return HEAD + "".join(_section(module, record) for module, record in records())


def records() -> Iterator[tuple[str, Any]]:
    """Every record of tuned numbers, and the module that holds it."""
    for package in PACKAGES:
        for found in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            module = importlib.import_module(found.name)
            for one in vars(module).values():
                if type(one).__module__ == module.__name__ and _is_record(one):
                    yield module.__name__, one


def _is_record(one: object) -> bool:
    return is_dataclass(one) and not isinstance(one, type) and all("guards" in each.metadata for each in fields(one))


def _section(module: str, record: Any) -> str:
    about = (type(record).__doc__ or "").split("\n\n")[0].replace("\n", " ")
    lines = ["| name | value | unit | guards against | source |", "| --- | --- | --- | --- | --- |"]
    for one in listed(record):
        cells = (f"`{one.name}`", f"{one.value}", one.unit, one.guards, one.source)
        lines.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return f"## {type(record).__name__}\n\n{about} (`{module}`)\n\n" + "\n".join(lines) + "\n\n"
