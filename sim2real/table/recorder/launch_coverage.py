"""Which launches of the puck a recording has, and which one helps most next.

A launch has a speed, a heading and a region of the table from which it starts; its wall contacts are counted too. What
is recorded evenly over these determines friction and drag (slow and fast), tilt and warp (all headings, everywhere) and
each wall's restitution.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from sim2real.table.backend import Motion

SPEEDS = {"slow": (0.3, 0.8), "medium": (0.8, 1.8), "fast": (1.8, 3.5)}  # m/s; beyond them the nearest counts
ALONG, ACROSS = ("robot's end", "middle", "opponent's end"), ("robot's right", "robot's left")
HEADINGS = (
    "opponent",
    "opponent and left",
    "left",
    "robot and left",
    "robot",
    "robot and right",
    "right",
    "opponent and right",
)  # fmt: skip - counterclockwise from x
WALLS = {"x0": "robot's end", "xL": "opponent's end", "y0": "robot's right", "yW": "robot's left"}
ENOUGH_CONTACTS = 4  # of each wall


@dataclass(frozen=True)
class Launch:
    """A launch by its classes: indices of SPEEDS, HEADINGS, ALONG and ACROSS."""

    speed: int
    heading: int
    along: int
    across: int

    @property
    def words(self) -> str:
        """The launch for the person at the table."""
        name, (low, high) = list(SPEEDS.items())[self.speed]
        place = f"{ALONG[self.along]}, {ACROSS[self.across]}"
        return f"{name} ({low:g} to {high:g} m/s), from the {place}, towards {HEADINGS[self.heading]}"


@dataclass
class LaunchCoverage:
    """The launches and wall contacts seen so far on a table of `length` and `width` [m]."""

    length: float
    width: float
    launches: list[Launch] = field(default_factory=list)
    contacts: dict[str, int] = field(default_factory=lambda: dict.fromkeys(WALLS, 0))

    def add(self, motion: Motion) -> None:
        """Count a launch that begins with this motion."""
        x, y, vx, vy = motion
        limits = [low for low, _ in SPEEDS.values()][1:]
        turn = int(np.round(np.arctan2(vy, vx) / (0.25 * np.pi))) % len(HEADINGS)
        along = int(np.clip(x / self.length * len(ALONG), 0, len(ALONG) - 1))
        across = int(np.clip(y / self.width * len(ACROSS), 0, len(ACROSS) - 1))
        self.launches.append(Launch(int(np.searchsorted(limits, np.hypot(vx, vy))), turn, along, across))

    def counts(self, name: str) -> np.ndarray:
        """The number of launches in each class of `speed`, `heading`, `along` or `across`."""
        sizes = {"speed": len(SPEEDS), "heading": len(HEADINGS), "along": len(ALONG), "across": len(ACROSS)}
        return np.bincount([getattr(one, name) for one in self.launches], minlength=sizes[name])

    def next(self, random: np.random.Generator) -> Launch:
        """The launch that helps most: of each kind of classes one that was seen least, drawn among equals."""
        chosen = {}
        for name in ("speed", "heading", "along", "across"):
            counts = self.counts(name)
            chosen[name] = int(random.choice(np.flatnonzero(counts == counts.min())))
        return Launch(**chosen)

    def motion(self, launch: Launch, edge: float, random: np.random.Generator) -> np.ndarray:
        """A puck (x, y, vx, vy) [m, m/s] that starts such a launch, at least `edge` [m] from the walls."""
        parts = np.array([launch.along, launch.across]) + random.uniform(0.0, 1.0, 2)
        size = np.array([self.length, self.width])
        place = np.clip(parts / [len(ALONG), len(ACROSS)] * size, edge, size - edge)
        speed = random.uniform(*list(SPEEDS.values())[launch.speed])
        heading = 0.25 * np.pi * (launch.heading + random.uniform(-0.5, 0.5))
        return np.array([*place, speed * np.cos(heading), speed * np.sin(heading)])

    @property
    def missing(self) -> list[str]:
        """What no launch, or too few wall contacts, covered yet."""
        names = {"speed": list(SPEEDS), "heading": [f"towards {one}" for one in HEADINGS], "along": list(ALONG),
                 "across": list(ACROSS)}  # fmt: skip
        none = [words[k] for name, words in names.items() for k in np.flatnonzero(self.counts(name) == 0)]
        few = [WALLS[name] for name, count in self.contacts.items() if count < ENOUGH_CONTACTS]
        return none + ([f"{ENOUGH_CONTACTS} contacts with the walls at {', '.join(few)}"] if few else [])

    @property
    def summary(self) -> str:
        """What was seen, in one line."""
        speeds = ", ".join(f"{count} {name}" for name, count in zip(SPEEDS, self.counts("speed"), strict=True))
        headings = int((self.counts("heading") > 0).sum())
        walls = ", ".join(f"{WALLS[name]} {count}" for name, count in self.contacts.items())
        rest = f"; still missing: {', '.join(self.missing)}" if self.missing else "; nothing is missing"
        return (
            f"{len(self.launches)} launches seen: {speeds}; {headings} of {len(HEADINGS)} headings; wall contacts: "
            f"{walls}{rest}"
        )
