"""The markers round a table and its surface, from several positions of the camera at once (report B.4).

A VIEW is a folder: view.png, a photograph with at least three markers, and pixels.csv with u,v,x,y: where the puck's
centre was seen [pixels] when it lay at a place measured by hand [m]. Three views from apart are good; all places
should be spread over the whole table. Writes table.json and, beside it, a picture of how far off each point is.
With --check the calibration is tested on a view that was not used: the camera is located by that view's markers alone,
and its pixels, mapped to the table, are compared with the measured places.
"""

from __future__ import annotations

import argparse
import json
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sim2real.vision.calibrate.calibration_view import CalibrationView
    from sim2real.vision.calibrate.holdout_view import HoldoutCheck
    from sim2real.vision.calibrate.multiview import MultiviewFit
    from sim2real.vision.calibrate.place_uncertainty import WorstKnownPlace
    from sim2real.vision.calibrate.width_check import WidthStep


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `calibrate table`."""
    parser.add_argument("views", nargs="+", type=Path, metavar="VIEW", help="folders of view.png and pixels.csv")
    parser.add_argument("--camera", type=Path, required=True, metavar="FILE", help="camera.json, of calibrate camera")
    parser.add_argument("--out", type=Path, default=Path("table.json"), metavar="FILE", help="(default table.json)")
    parser.add_argument("--check", type=Path, metavar="VIEW", help="a view to test the calibration on")
    parser.add_argument("--json", action="store_true", help="print one JSON object in the end")


def run(args: argparse.Namespace) -> int:
    """Calibrate the table and write table.json and the plot. Returns 0; raises ValueError, in one line, if that is
    impossible."""
    from puckpilot_env.files.whole_file import check_folder, write_whole
    from sim2real.vision.calibrate.calibration_view import read_view
    from sim2real.vision.calibrate.holdout_view import check_holdout
    from sim2real.vision.calibrate.multiview import solve
    from sim2real.vision.calibrate.place_uncertainty import worst_known_place
    from sim2real.vision.calibrate.table_file import write_table
    from sim2real.vision.calibrate.width_check import width_step
    from sim2real.vision.camera_file import read_setup

    if args.out.suffix != ".json":
        raise ValueError(f"--out is '{args.out}'; expected a name that ends in .json, the picture's then ends in .png")
    setup = read_setup(args.camera)
    check_folder(args.out.absolute().parent)
    begin = time.perf_counter()
    folders = [*args.views, *([args.check] if args.check else [])]
    views = [read_view(folder, setup) for folder in folders]
    _refuse_twice(folders, views)
    fit = solve(setup, tuple(views[: len(args.views)]))
    seconds = time.perf_counter() - begin
    checked = check_holdout(setup, fit.geometry, views[-1]) if args.check else None
    step, weak = width_step(fit, setup.width), worst_known_place(fit, setup.length, setup.width)
    write_table(args.out, setup, fit)

    from sim2real.vision.calibrate.residual_plot import (
        write_plot,  # matplotlib is slow to load, and nothing else here needs it
    )

    picture = write_whole(args.out.with_suffix(".png"), lambda draft: write_plot(draft, setup, fit, checked))
    result = {"file": str(args.out), "picture": str(picture), "seconds": round(seconds, 2), **_result(fit, step, weak)}
    if checked is not None:
        result = {**_figures(checked), **result}
    if args.json:
        print(json.dumps(result, indent=1, allow_nan=False))
    else:
        print("\n".join(_lines(result, fit, setup.width)))
    return 0


def _refuse_twice(folders: list[Path], views: list[CalibrationView]) -> None:
    """Raise ValueError for a photograph that is given twice: a check on a view of the fit would prove nothing."""
    seen: dict[bytes, Path] = {}
    for folder, view in zip(folders, views, strict=True):
        corners = b"".join(corners.tobytes() for corners in view.corners.values())
        if (other := seen.setdefault(corners, folder)) is not folder:
            raise ValueError(
                f"{folder} shows the same photograph as {other}; give each once, for the fit or to --check"
            )


def _result(fit: MultiviewFit, step: WidthStep | None, weak: WorstKnownPlace) -> dict[str, Any]:
    """The result of the fit as a JSON object."""
    import numpy as np

    std = np.sqrt(np.diag(fit.geometry_covariance()))
    far = 1e3 * np.concatenate([np.hypot(*off.T) for off in fit.off])
    return {
        "views": [view.name for view in fit.problem.views],
        "markers": len(fit.geometry.markers),
        "fit": {"points": len(far), "mean_mm": float(far.mean()), "max_mm": float(far.max())},
        "corner_rms_px": fit.corner_rms,
        "bend_mm": 1e3 * fit.warp,
        "marker_std_mm": float(1e3 * np.sqrt((fit.marker_std() ** 2).mean())),
        "surface_per_m": {
            name: {"value": value, "std": float(one)}
            for name, value, one in zip(("xx", "xy", "yy"), fit.geometry.surface.curvature, std, strict=False)
        },
        "wrong": [
            {"view": view.name, "point": int(k) + 1, "off_mm": float(1e3 * np.hypot(*off[k]))}
            for view, off, wrong in zip(fit.problem.views, fit.off, fit.wrong, strict=True)
            for k in np.flatnonzero(wrong)
        ],
        "step_across": None if step is None else {"mm": 1e3 * step.value, "std": 1e3 * step.std, "clear": step.clear},
        "weakest": {
            "place_m": weak.place.tolist(),
            "std_mm": 1e3 * weak.std,
            "nearest_point_m": weak.away,
            "matters": weak.matters,
        },
    }


def _figures(checked: HoldoutCheck) -> dict[str, Any]:
    """The errors on the unused view as a JSON object."""
    import numpy as np

    far = 1e3 * checked.distances
    return {
        "check": checked.view.name,
        "mean_mm": float(far.mean()),
        "median_mm": float(np.median(far)),
        "max_mm": float(far.max()),
        "farthest_point": int(np.argmax(far)) + 1,
        "markers_rms_px": checked.pose.rms,
    }


def _lines(result: dict[str, Any], fit: MultiviewFit, width: float) -> list[str]:
    """The result as lines of text."""
    points, surface = result["fit"], result["surface_per_m"]
    heights = ", ".join(f"{name} {1e3 * one['value']:.2f} ± {1e3 * one['std']:.2f}" for name, one in surface.items())
    corners = ", ".join(f"{name} {rms:.2f}" for name, rms in zip(result["views"], result["corner_rms_px"], strict=True))
    lines = [
        f"{len(result['views'])} views, {result['markers']} markers, {points['points']} points in "
        f"{result['seconds']:.1f} s: points {points['mean_mm']:.2f} mm off on average, {points['max_mm']:.2f} mm at "
        "most",
        f"corners of markers, px rms: {corners}; marker position std {result['marker_std_mm']:.1f} mm",
        f"surface, mm at 1 m from the middle: {heights}; measured places bend by up to {result['bend_mm']:.1f} mm",
        *(
            f"wrong measurement: {one['view']}, point {one['point']}, {one['off_mm']:.1f} mm off"
            for one in result["wrong"]
        ),
    ]
    step = result["step_across"]
    if step is not None and step["clear"]:
        lines.append(
            f"stated points in the left half are {step['mm']:.1f} ± {step['std']:.1f} mm too far left relative to "
            "those in the right half: if they were measured from the left wall, the table is "
            f"{width - 1e-3 * step['mm']:.4f} m wide, not {width:g}; coordinates here follow the stated ones as well "
            "as a smooth map can"
        )
    weak = result["weakest"]
    if weak["matters"]:
        lines.append(
            f"the table is not covered: at ({weak['place_m'][0]:.2f}, {weak['place_m'][1]:.2f}), "
            f"{weak['nearest_point_m']:.2f} m from any point, places are known to {weak['std_mm']:.0f} mm only; lay "
            "the puck there, too"
        )
    if "check" in result:
        from sim2real.vision.calibrate.pose import FAR

        lines.append(
            f"check on {result['check']}, not used: mean {result['mean_mm']:.2f} mm, median "
            f"{result['median_mm']:.2f} mm, max {result['max_mm']:.2f} mm (point {result['farthest_point']}); markers "
            f"{result['markers_rms_px']:.2f} px rms"
            + (
                ""
                if result["markers_rms_px"] <= FAR
                else f", too far: expected {FAR:g} at most; was one of them moved?"
            )
        )
    return [*lines, f"{result['file']} holds it; {result['picture']} shows it"]
