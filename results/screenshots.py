"""Pictures of the arena's modes for the documents: what a browser without a window shows of an arena of its own."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
FOLDER = Path("docs") / "assets"
QUALITY = 80
DEMO = "sim2real/demo_recording"
WIDE, NARROW = (960, 620), (390, 700)
LONGEST = 600.0  # s that a page may take
# Matches of which the tournament's page shows the standings: the seats' players, and the goals
PLAYED = (
    ("goalie", "interceptor", 4, 7), ("interceptor", "goalie", 7, 2), ("goalie", "veteran", 1, 7),
    ("veteran", "goalie", 7, 3), ("interceptor", "veteran", 5, 7), ("veteran", "interceptor", 7, 4),
)  # fmt: skip


@dataclass(frozen=True)
class Screenshot:
    """A picture `arena_NAME.jpg`: of `puckpilot arena` with these words, once `act` has done what leads there."""

    words: tuple[str, ...]
    act: Callable[[Any], None]
    size: tuple[int, int] = WIDE
    scheme: Literal["light", "dark"] = "light"
    query: str = ""


def _play(page: Any) -> None:
    """Wait until play goes on, and move the mallet."""
    _until(page, "Number(document.getElementById('table').dataset.shown) > 2")
    box = page.locator("#table").bounding_box()
    for k in range(40):
        page.mouse.move(box["x"] + (0.14 + 0.003 * k) * box["width"], box["y"] + (0.3 + 0.006 * k) * box["height"])
        page.wait_for_timeout(25)


def _watch(page: Any) -> None:
    _until(page, "Number(document.getElementById('table').dataset.shown) > 3")


def _ratings(page: Any) -> None:
    _watch(page)
    page.click("#ratings")
    page.wait_for_timeout(300)


def _replay(page: Any) -> None:
    _until(page, "document.getElementById('table').dataset.shown !== undefined")


def _diagnosed(page: Any) -> None:
    """Let the recording be diagnosed, and show the prediction with what was found."""
    _replay(page)
    page.click("#diagnose")
    _until(page, "!document.getElementById('findings').hidden")
    page.select_option("#law", "after")
    page.wait_for_timeout(300)


def _concealed(page: Any) -> None:
    """Watch a match to its end, and let its recording be diagnosed, which then says what was concealed."""
    _until(page, "!document.getElementById('replay').hidden")
    page.goto(page.evaluate("document.getElementById('replay').href"))
    _diagnosed(page)


SCREENSHOTS = {
    "play": Screenshot(("interceptor",), _play),
    "phone": Screenshot(("interceptor", "veteran"), _watch, NARROW, "dark"),
    "tournament": Screenshot(("goalie", "interceptor", "veteran"), _ratings),
    "replay": Screenshot((DEMO,), _replay, query="&at=13.8"),
    "concealed": Screenshot(("veteran", "interceptor", "--concealed", "--seed", "13"), _concealed, (960, 800)),
    "diagnosed": Screenshot((DEMO,), _diagnosed, (960, 760), query="&at=13.8"),
}


def take(root: Path, names: Sequence[str]) -> list[Path]:
    """Take the pictures of these names, or all, and return their files. ValueError, in one line, for another name, and
    where there is no browser."""
    unknown = set(names) - set(SCREENSHOTS)
    if unknown:
        raise ValueError(f"there is no screenshot {', '.join(sorted(unknown))}; expected {', '.join(SCREENSHOTS)}")
    browser = next(filter(None, map(shutil.which, BROWSERS)), None)
    if browser is None:
        raise ValueError(f"no browser is installed; expected one of {', '.join(BROWSERS)}")
    from playwright.sync_api import sync_playwright

    written = []
    with sync_playwright() as started:
        chromium = started.chromium.launch(executable_path=browser, args=["--no-sandbox"])
        for name in names or SCREENSHOTS:
            one, file = SCREENSHOTS[name], root / FOLDER / f"arena_{name}.jpg"
            with _arena(root, one.words) as address:
                width, height = one.size
                page = chromium.new_page(viewport={"width": width, "height": height}, color_scheme=one.scheme)
                page.goto(address + one.query)
                one.act(page)
                page.screenshot(path=file, type="jpeg", quality=QUALITY)
                page.close()
            written.append(file)
        chromium.close()
    return written


@contextmanager
def _arena(root: Path, words: Sequence[str]) -> Iterator[str]:
    """The address of an arena with some matches behind it."""
    with tempfile.TemporaryDirectory() as folder:
        lines = [json.dumps({"players": [one, two], "score": score}) for one, two, *score in PLAYED]
        (Path(folder) / "games.jsonl").write_text("".join(f"{line}\n" for line in lines))
        command = [sys.executable, "-m", "puckpilot", "arena", *words, "--port", "0", "--out", folder]
        with subprocess.Popen(command, cwd=root, stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            try:
                yield process.stdout.readline().split()[0]
            finally:
                process.terminate()


def _until(page: Any, holds: str) -> None:
    """Wait until something holds in the page, whose policy forbids the browser's own way. ValueError if it does not."""
    for _ in range(round(LONGEST / 0.1)):
        if page.evaluate(holds):
            return
        page.wait_for_timeout(100)
    raise ValueError(f"in {LONGEST:g} s the page did not come to {holds}")
