"""What a diagnosis costs: its time and memory by the length of the recording, each in a process of its own."""

from __future__ import annotations

import multiprocessing
import resource
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path

from sim2real.diagnose.pipeline import diagnose
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table.cases import draw_case
from sim2real.study.independent_table.recorder.record import make_recording

SCENARIO, STEP = "match", 1e-4  # play of both seats; s, of the table's integration
COMPILING = 20.0  # s of play that are diagnosed beforehand, so that no figure holds the time of compiling
RSS_UNIT = 1 if sys.platform == "darwin" else 1024  # bytes of getrusage's ru_maxrss


@dataclass(frozen=True)
class Cost:
    """The cost of one diagnosis: `play_s` of play; processor time and time by the clock [s]; most memory at once
    [bytes]; what was found."""

    play_s: float
    processor_s: float
    clock_s: float
    peak_bytes: int
    verdict: str
    mechanisms: list[str]


def diagnosis_costs(
    lengths: Sequence[float], mechanism: str, seed: int, progress: Callable[[int, int], None]
) -> Iterator[Cost]:
    """Diagnose plays of these lengths [s] on a table with a mechanism, of which a seed draws the size. ValueError, in
    one line, for an unknown mechanism."""
    draw_case(seed, 0, None, mechanism)
    context = multiprocessing.get_context("spawn")
    with tempfile.TemporaryDirectory(prefix="costs-") as folder:
        for number, seconds in enumerate([COMPILING, *lengths]):
            progress(number, len(lengths) + 1)
            with ProcessPoolExecutor(1, mp_context=context) as pool:
                place = pool.submit(_play, Path(folder) / str(number), mechanism, seed, seconds).result()
            with ProcessPoolExecutor(1, mp_context=context) as pool:
                cost = pool.submit(_cost, place, seconds).result()
            if number:
                yield cost


def _play(folder: Path, mechanism: str, seed: int, seconds: float) -> Path:
    case = draw_case(seed, 0, None, mechanism)
    noise, hand = case.encoder_noise, case.hand
    make_recording(folder, case.law, SCENARIO, seed, seconds, case.camera, encoder_noise=noise, hand=hand, dt=STEP)
    return folder


def _cost(folder: Path, play_s: float) -> Cost:
    recording = read_recording(folder)
    processor, clock = time.process_time(), time.perf_counter()
    found = diagnose([recording], [], {}, lambda stage, share: None)
    took = time.process_time() - processor, time.perf_counter() - clock
    return Cost(play_s, *took, _peak_bytes(), found.verdict, [finding.mechanism for finding in found.findings])


def _peak_bytes() -> int:
    """The most memory [bytes] that this process had. Linux counts that of the parent in getrusage's figure, too."""
    status = Path("/proc/self/status")
    lines = status.read_text(encoding="ascii", errors="replace").splitlines() if status.exists() else []
    own = next((line for line in lines if line.startswith("VmHWM:")), "")
    if own:
        return 1024 * int(own.split()[1])
    return RSS_UNIT * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
