"""Tuned numbers of the pipeline: checks of recordings, their split, and the data that a regime needs."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class InputNumbers:
    """Conditions that recordings must meet."""

    least_seconds: float = tuned(5.0, "s", "a verdict on too little data", "choice: some launches of the puck")
    still: float = tuned(0.01, "m", "a puck or mallet at rest counted as moving", "choice: far beyond the noise")
    stops_early: float = tuned(
        0.2, "1", "a cut-off stream taken for the end of the motion", "choice: a share of the recording"
    )
    stops_by: float = tuned(2.0, "s", "the same, of short recordings", "choice: longer than any rest between plans")
    pause: float = tuned(0.5, "s", "streams whose clocks were reset during a gap", "choice: many rows of any stream")
    pause_edge: float = tuned(0.1, "s", "recorders that stop one stream after the other", "choice: a fifth of a pause")


@dataclass(frozen=True)
class SplitNumbers:
    """Which part of the data is held out."""

    launches: int = tuned(
        6, "1", "a holdout too small to test anything, or a fit with too little data", "choice: a sixth"
    )
    fewest_contacts: int = tuned(
        4,
        "1",
        "training data that do not determine the position of a wall",
        "choice: two more than the parameters of a line",
    )
    longest_block: float = tuned(3.0, "s", "a holdout of the gantry in one block", "choice: several plans")
    fewest_blocks: int = tuned(20, "1", "short paths without a holdout", "choice: several blocks in each part")


@dataclass(frozen=True)
class ConsistencyNumbers:
    """When recordings of one call are not of one table (Chow, 1960)."""

    fewest_launches: int = tuned(
        6, "1", "a law fitted to a recording too small for it", "choice: one in each direction"
    )
    fewest_residuals: int = tuned(24, "1", "the same", "choice: several for each parameter of a law")
    deviations: float = tuned(
        8.0, "standard deviations", "one table taken for two by chance", "choice: impossible by chance"
    )
    relative: float = tuned(0.1, "1", "one table on two days taken for two", "choice: a possible change of a table")
    harm: float = tuned(30.0, "dispersion", "a difference of no consequence", "choice: far beyond chi-square's spread")
    worse: float = tuned(
        1.1, "1", "a law that hardly worsens another recording", "choice: a tenth more loss than without it"
    )
    worse_unlisted: float = tuned(
        1.5, "1", "the flexibility of many coefficients", "choice: more than they fit by chance"
    )
    explained: float = tuned(1.3, "1", "a law that explains neither recording", "choice: nearly the noise")
    unexplained: float = tuned(2.0, "1", "a recording that no law explains", "choice: clearly more than the noise")


@dataclass(frozen=True)
class IdentificationNumbers:
    """When a regime has enough data to be identified."""

    fewest_launches: int = tuned(4, "1", "a verdict on a regime with hardly any data", "choice: fewer predict nothing")
    fewest_residuals: int = tuned(8, "1", "the same", "choice: two for each launch")


@dataclass(frozen=True)
class ResidualNumbers:
    """How residuals are judged."""

    as_noise: float = tuned(
        1.3, "times the noise", "an error of the noise level reported as a misfit", "choice: a third"
    )
    large: float = tuned(
        3.0, "times the noise", "small misfits in the summary, beside which the findings are overlooked",
        "choice: visible in every figure",
    )  # fmt: skip
    worse: float = tuned(
        1.02, "times the holdout residual without a law", "chance that seems to contradict a finding", "choice: little"
    )


INPUT = InputNumbers()
SPLIT = SplitNumbers()
CONSISTENCY = ConsistencyNumbers()
IDENTIFICATION = IdentificationNumbers()
RESIDUALS = ResidualNumbers()
