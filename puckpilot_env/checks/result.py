"""What a check is and what it says: a finding is a fact, what it means, and what to do; passes are said aloud too."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

ERROR, WARNING, INFO = "error", "warning", "info"  # how much a finding weighs; only errors fail an environment


@dataclass(frozen=True)
class CheckResult:
    """The finding of one check."""

    name: str
    passed: bool
    meaning: str  # what it is good for, passed or not
    remedy: str  # what to do if it did not pass
    detail: str  # the fact: what was seen, where
    level: str = ERROR

    @property
    def failed(self) -> bool:
        """True where the environment breaks a promise; findings of a lower level are only worth knowing."""
        return not self.passed and self.level == ERROR

    def __str__(self) -> str:
        if self.passed:
            return f"passed: {self.name}: {self.detail}"
        return f"{self.level}: {self.name}: {self.detail}. {self.meaning} {self.remedy}"


@dataclass(frozen=True)
class Subject:
    """The environment under check."""

    make: Callable[..., Any]  # makes a new one; options such as `render_mode` are passed on
    steps: int
    seed: int


class Fault(Exception):  # noqa: N818 - not an error of this program
    """What a check found wrong, as a fact."""

    def __init__(self, detail: str, level: str = ERROR) -> None:
        super().__init__(detail)
        self.level = level


class UndeterminedError(Exception):
    """Why a check could see neither good nor bad."""


@dataclass(frozen=True)
class Check:
    """One check. `function` returns the fact that it passed on, or raises `Fault` or `UndeterminedError`."""

    name: str
    meaning: str
    remedy: str
    function: Callable[[Subject], str]

    def run(self, subject: Subject) -> CheckResult:
        """Its finding about an environment; an exception out of the environment is a finding too."""
        try:
            detail, passed, level = self.function(subject), True, ERROR
        except Fault as fault:
            detail, passed, level = str(fault), False, fault.level
        except UndeterminedError as reason:
            detail, passed, level = f"not determined: {reason}", False, WARNING
        except Exception as error:
            detail, passed, level = f"raised {describe(error)}", False, ERROR
        return CheckResult(self.name, passed, self.meaning, self.remedy, detail, level)


def describe(error: BaseException) -> str:
    """An exception in one line."""
    return f"{type(error).__name__}: {' '.join(str(error).split())[:200]}"
