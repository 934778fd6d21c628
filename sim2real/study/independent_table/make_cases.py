"""Make cases for a diagnosis: `python -m sim2real.study.independent_table.make_cases --cases 20 --seed 1 --out DIR`.

DIR/recordings/case_0001/ is the input of the diagnosis, DIR/heldout/case_0001/ another recording of the same table, and
DIR/key/case_0001.json the truth. Existing cases are kept.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path

import numpy as np

from sim2real.study.independent_table.cases import draw_case
from sim2real.study.independent_table.mechanisms import MECHANISMS
from sim2real.study.independent_table.physics.unlisted import LAWS
from sim2real.study.independent_table.recorder.record import make_recording
from sim2real.study.independent_table.simulate import run

STEP = 1e-4  # s; at ten times the usual step the paths still agree to 1e-8 m between two jumps of a force
HELDOUT_SHARE = 0.5  # length of the holdout recording by that of the recording


def key_file(out: Path, number: int) -> Path:
    """The key file of a case; its stem is the case's name."""
    return out / "key" / f"case_{number + 1:04d}.json"


def make_case(
    out: Path, seed: int, seconds: float, kind: str | None, name: str | None, filmed: bool, number: int
) -> str:
    """Write one case, the key last, and return its name."""
    key = key_file(out, number)
    label = key.stem
    if key.exists():
        return label
    case = draw_case(seed, number, kind, name, filmed)
    for part, (folder, lasts) in enumerate((("recordings", seconds), ("heldout", HELDOUT_SHARE * seconds))):
        draw = int(np.random.SeedSequence([seed, number, part]).generate_state(1)[0])
        make_recording(
            out / folder / label, case.law, case.scenario, draw, lasts, case.camera,
            encoder_noise=case.encoder_noise, hand=case.hand, dt=STEP,
        )  # fmt: skip
    key.parent.mkdir(parents=True, exist_ok=True)
    key.write_text(json.dumps({**case.truth, "seconds": seconds}, indent=1) + "\n", newline="\n")
    return label


def main(arguments: Sequence[str] | None = None) -> None:
    """Make the cases in several processes; print the name of each finished case."""
    parser = argparse.ArgumentParser(description="write labelled recordings of randomly drawn tables")
    parser.add_argument("--cases", type=int, required=True, metavar="N")
    parser.add_argument("--seed", type=int, default=0, metavar="S")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--seconds", type=float, default=60.0, help="length of a recording (default 60)")
    parser.add_argument("--only", metavar="KIND", help="nothing, parameters, one, two, unlisted or disturbed")
    parser.add_argument("--mechanism", metavar="NAME", help=f"one of {', '.join([*MECHANISMS, *LAWS])}")
    parser.add_argument("--filmed", action="store_true", help="by a calibrated camera")
    parser.add_argument("--workers", type=int, default=2)
    args = parser.parse_args(arguments)
    try:
        draw_case(args.seed, 0, args.only, args.mechanism)
    except ValueError as error:
        parser.error(str(error))
    if not all(key_file(args.out, number).exists() for number in range(args.cases)):
        run(draw_case(args.seed, 0).law, (1.0, 0.5, 1.0, 0.0), [(0.3, 0.5)], duration=0.01)  # compiled before the fork
    make = partial(make_case, args.out, args.seed, args.seconds, args.only, args.mechanism, args.filmed)
    with ProcessPoolExecutor(args.workers, multiprocessing.get_context("fork")) as pool:
        for label in pool.map(make, range(args.cases)):
            print(label, flush=True)


if __name__ == "__main__":
    main()
