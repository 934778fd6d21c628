"""The region of interest: the part of its sensor that a camera sends."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Self

FORM = "WIDTHxHEIGHT+COLUMN+ROW, 1300x1450+396+20 say"


@dataclass(frozen=True)
class RegionOfInterest:
    """A part of a sensor: the column and row of its first pixel, its width and height [pixels]. Raises ValueError, in
    one line, if there is no such part."""

    column: int
    row: int
    width: int
    height: int

    def __post_init__(self) -> None:
        if min(self.column, self.row) < 0 or min(self.width, self.height) < 1:
            raise ValueError(f"a region of interest is {self}; expected {FORM}, pixels from 0 on")

    @classmethod
    def parse(cls, word: str) -> Self:
        """The region that a word of the form of `str` names. Raises ValueError, in one line, for any other word."""
        found = re.fullmatch(r"(\d{1,6})x(\d{1,6})\+(\d{1,6})\+(\d{1,6})", word)
        if found is None:
            raise ValueError(f"a region of interest is {word[:60]!r}; expected {FORM}")
        width, height, column, row = map(int, found.groups())
        return cls(column, row, width, height)

    def __str__(self) -> str:
        return f"{self.width}x{self.height}+{self.column}+{self.row}"

    @property
    def size(self) -> tuple[int, int]:
        """Width and height [pixels]."""
        return self.width, self.height

    def check_within(self, sensor: tuple[int, int]) -> None:
        """Raise ValueError, in one line, if the region reaches beyond a sensor of this width and height [pixels]."""
        if self.column + self.width > sensor[0] or self.row + self.height > sensor[1]:
            raise ValueError(
                f"the region of interest {self} reaches beyond the {sensor[0]}x{sensor[1]} pixels for which the camera "
                "is calibrated; choose one inside, or calibrate this camera"
            )
