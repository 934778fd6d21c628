"""MkDocs hook: the page of every environment, as it stands in `puckpilot_env/pages/`, with its pictures."""

from __future__ import annotations

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

from puckpilot_env.documentation.page import FOLDER

HOME = "reference/environments"


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add every page and picture."""
    for path in sorted(FOLDER.iterdir()):
        files.append(File.generated(config, f"{HOME}/{path.name}", abs_src_path=str(path)))
    return files
