"""Tuned numbers of the pipeline: what is asked of recordings, how they are split, and when a regime is identified."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class InputNumbers:
    """What recordings must be like to be believed at all."""

    least_seconds: float = tuned(5.0, "s", "a verdict on hardly any data", "choice: some launches of the puck")
    still: float = tuned(0.01, "m", "a puck or mallet at rest taken for one that moves", "choice: far beyond the noise")
    stops_early: float = tuned(
        0.2, "1", "a stream that was cut off and looks as if the motion had ended", "choice: a share of the recording"
    )
    stops_by: float = tuned(2.0, "s", "the same, of short recordings", "choice: longer than any rest between plans")
    pause: float = tuned(0.5, "s", "streams whose clocks were set anew during a gap", "choice: many rows of any stream")


@dataclass(frozen=True)
class SplitNumbers:
    """Which part of the data is held out."""

    launches: int = tuned(6, "1", "a holdout too small to show anything, or a fit that lacks data", "choice: a sixth")
    fewest_contacts: int = tuned(
        4, "1", "a training part that does not determine where a wall is", "choice: two more than a line has numbers"
    )
    longest_block: float = tuned(3.0, "s", "a holdout of the gantry in one piece", "choice: some plans long")
    fewest_blocks: int = tuned(20, "1", "short paths without a holdout", "choice: several blocks in each part")


@dataclass(frozen=True)
class ConsistencyNumbers:
    """When recordings of one call are taken for two tables (Chow, 1960)."""

    fewest_launches: int = tuned(6, "1", "a law asked of a recording too small for it", "choice: one in each direction")
    fewest_residuals: int = tuned(24, "1", "the same", "choice: several for each number of a law")
    deviations: float = tuned(8.0, "standard deviations", "one table called two by chance", "choice: beyond any chance")
    relative: float = tuned(0.1, "1", "one table on two days called two", "choice: what a table may change by")
    harm: float = tuned(30.0, "dispersion", "a difference of no consequence", "choice: far beyond chi-square's spread")
    worse: float = tuned(1.1, "1", "a law that hardly harms another recording", "choice: a tenth more than without it")
    worse_unlisted: float = tuned(
        1.5, "1", "the freedom of a law's many coefficients", "choice: more than they take up by chance"
    )
    explained: float = tuned(1.3, "1", "a law that explains neither recording", "choice: nearly the noise")
    unexplained: float = tuned(2.0, "1", "a recording that no law explains", "choice: clearly more than the noise")


@dataclass(frozen=True)
class IdentificationNumbers:
    """When a regime has enough data to be identified."""

    fewest_launches: int = tuned(4, "1", "a verdict on a regime that was hardly seen", "choice: fewer predict nothing")
    fewest_residuals: int = tuned(8, "1", "the same", "choice: two for each launch")


INPUT = InputNumbers()
SPLIT = SplitNumbers()
CONSISTENCY = ConsistencyNumbers()
IDENTIFICATION = IdentificationNumbers()
