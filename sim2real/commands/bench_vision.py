"""Measure the errors and the run time of the vision on this machine: one core, rendered pictures of 1440 x 1080 pixels.

The calibration is estimated from rendered views and places measured to 0.3 mm. Errors are those of the puck's centre,
clear and half hidden by the gantry, for three methods: the disc fit that the tracker uses; the report's rules, with the
correct outline and the previous place given; and the outline's centroid. Times are for new pictures, as in play.
"""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

MOST = 100_000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "--pictures", type=int, default=500, metavar="N", help="number of pictures for each figure (500)"
    )
    parser.add_argument("--seed", type=int, default=0, help="of the calibration's errors and of all pictures (0)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Measure and print. Returns 0; raises ValueError, in one line, for an invalid option."""
    if not 1 <= args.pictures <= MOST:
        raise ValueError(f"--pictures is {args.pictures}; expected a whole number from 1 to {MOST:,}")
    if args.seed < 0:
        raise ValueError(f"--seed is {args.seed}; expected a whole number from 0")

    import numpy as np

    from baselines.commands.options import progress_bar
    from sim2real.vision.trial.bench import BenchmarkTable, centre_errors, detection_times

    with progress_bar("calibrating, timing, measuring") as progress:
        bench = BenchmarkTable.with_estimated_calibration(args.seed)
        progress(1, 4)
        result: dict[str, Any] = {
            name: {
                "median_ms": 1e3 * float(np.median(took[:, 0])),
                "p90_ms": 1e3 * float(np.percentile(took[:, 0], 90)),
                "again_median_ms": 1e3 * float(np.median(took[:, 1])),
            }
            for name, took in detection_times(bench, args.pictures, args.seed).items()
        }
        for hidden, name in enumerate(("clear", "half hidden")):
            progress(2 + hidden, 4)
            found = centre_errors(bench, args.pictures, bool(hidden), args.seed + 1 + hidden)
            result[name] = {method: _figures(far) for method, far in found.items()}
    if args.json:
        print(json.dumps(result, indent=1, allow_nan=False))
        return 0
    for name in ("full frame", "region of interest"):
        one = result[name]
        print(
            f"{name:20}{one['median_ms']:.2f} ms median, {one['p90_ms']:.2f} in 9 of 10; "
            f"{one['again_median_ms']:.2f} for the same picture again"
        )
    for name in ("clear", "half hidden"):
        for method, one in result[name].items():
            print(
                f"{name:12}{method:12}mm: mean {one['mean_mm']:.3f}, median {one['median_mm']:.3f}, "
                f"p95 {one['p95_mm']:.3f}, p99 {one['p99_mm']:.3f}; found in {one['found']} of {one['pictures']}"
            )
    return 0


def _figures(far: np.ndarray) -> dict[str, Any]:
    """Statistics of distances (n,) [m], NaN if nothing was found, as a JSON object."""
    import numpy as np

    mm = 1e3 * far[np.isfinite(far)]
    figures = {"mean_mm": np.mean, "median_mm": np.median}
    result: dict[str, Any] = {name: float(of(mm)) if len(mm) else None for name, of in figures.items()}
    result |= {f"p{share}_mm": float(np.percentile(mm, share)) if len(mm) else None for share in (95, 99)}
    return {**result, "found": len(mm), "pictures": len(far)}
