"""A made-up repository with three runs and a README that agrees with them."""

from __future__ import annotations

import subprocess
from pathlib import Path

RUNS = """format = "puckpilot-runs/1"

[figures]
sums = [{ name = "sum", what = "sum", values = ["/sum"], show = "{}", bar = { words = "at least 4", least = 4 } }]

[[run]]
id = "add-{each}"
each = ["3", "5"]
topic = "Sums"
title = "two and {each}"
command = ["python", "-c", "print('{\\"sum\\":', 2 + {each}, '}')", "--seed", "7", "--json"]
minutes = 0.1
figures = "sums"

[[run]]
id = "words"
topic = "Words"
title = "a text"
command = ["python", "-c", "import os; print(os.getcwd() + '/x', 'found 12 of 1,300')"]
minutes = 2
seed = 3
figures = [{ name = "found", what = "found", find = 'found (\\d+) of (\\S+)', show = "{} of {:,}" }]
"""
README = """# House

The sum is **5** <!-- result: add-3.sum -->, and

| a | b |
| --- | --- |
| found 12 of
1,300 <!-- result: words.found --> | `7 <!-- result: nothing.at-all -->` |

```
8 <!-- result: add-3.sum -->
```
"""


def git(root: Path, *words: str) -> str:
    who = ("-c", "user.name=a", "-c", "user.email=a@b")
    return subprocess.run(["git", *who, *words], cwd=root, capture_output=True, text=True, check=True).stdout.strip()
