"""Whether an environment keeps PettingZoo's promises, checked harder than upstream does; each check is in `checks/`.

from puckpilot_env.check import run_checks
for result in run_checks("puckpilot/match-v0"):
    print(result)
"""

from __future__ import annotations

from puckpilot_env.checks.result import CheckResult
from puckpilot_env.checks.runner import check_names, run_checks

__all__ = ["CheckResult", "check_names", "run_checks"]
