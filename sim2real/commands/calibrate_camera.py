"""Calibrate a camera's intrinsics from a dozen photographs of a flat board, from all sides, tilted by 20 to 45 degrees.

The boards together should cover the picture up to its corners. Writes camera.json, in which the user adds what the
table's calibration needs: the dictionary of the table's markers, the height of the puck's mark, and the table's size. A
photograph that contradicts the others is reported.
"""

from __future__ import annotations

import argparse
import json
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import numpy as np

    from sim2real.vision.calibrate.intrinsics.board import CalibrationBoard
    from sim2real.vision.calibrate.intrinsics.calibrate import Intrinsics

BOARD = "9x6"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `calibrate camera`."""
    parser.add_argument("images", nargs="+", type=Path, metavar="IMAGE", help="photographs, 8-bit grey, of one size")
    parser.add_argument("--board", default=BOARD, metavar="CxR", help=f"inner corners a row and a column ({BOARD})")
    parser.add_argument(
        "--charuco", metavar="DICT", help="the board is a ChArUco board of this dictionary, DICT_4X4_50 say"
    )
    parser.add_argument(
        "--marker", type=float, default=0.75, metavar="SHARE", help="a ChArUco marker's side in squares (0.75)"
    )
    parser.add_argument("--out", type=Path, default=Path("camera.json"), metavar="FILE", help="(default camera.json)")
    parser.add_argument("--json", action="store_true", help="print one JSON object in the end")


def run(args: argparse.Namespace) -> int:
    """Calibrate the camera and write the file. Returns 0; raises ValueError, in one line, if that is impossible."""
    from puckpilot_env.files.whole_file import check_folder
    from sim2real.vision.calibrate.intrinsics.board import CalibrationBoard
    from sim2real.vision.calibrate.intrinsics.calibrate import calibrate
    from sim2real.vision.camera_file import write_camera

    size = re.fullmatch(r"(\d{1,2})x(\d{1,2})", args.board)
    if size is None or min(int(size[1]), int(size[2])) < 3:
        raise ValueError(f"--board is '{args.board}'; expected inner corners like {BOARD}, 3 at least each way")
    if not 0.1 <= args.marker < 1.0:
        raise ValueError(f"--marker is {args.marker:g}; expected a share of a square from 0.1 to below 1")
    if args.out.exists():  # do not overwrite values that were filled in by hand
        raise ValueError(f"{args.out} exists already; choose another name or remove it")
    check_folder(args.out.absolute().parent)
    seen, (width, height) = _find(CalibrationBoard(int(size[1]), int(size[2]), args.charuco, args.marker), args.images)
    names = [str(path) for path in seen]
    if not names:
        raise ValueError(
            f"a board of {args.board} inner corners is seen in none of {len(args.images)} photographs; see --board"
        )
    found = calibrate(names, list(seen.values()), (width, height))
    without = [str(path) for path in args.images if path not in seen]
    result = {"file": str(args.out), **_result(names, found), "without_board": without}
    args.out.parent.mkdir(parents=True, exist_ok=True)
    write_camera(args.out, found.camera, f"rms {result['rms_px']:.3f} px over {len(names)} photographs")
    print(json.dumps(result, indent=1, allow_nan=False) if args.json else "\n".join(_lines(result, width, height)))
    return 0


def _find(
    board: CalibrationBoard, paths: list[Path]
) -> tuple[dict[Path, tuple[np.ndarray, np.ndarray]], tuple[int, int]]:
    """Find the board's corners in each photograph that shows it; return these and the photographs' width and height.

    Raises ValueError for photographs of different sizes and for the same photograph twice.
    """
    from baselines.commands.options import progress_bar
    from sim2real.camera.grey_image import read_grey

    seen, first, shape = {}, {}, None
    with progress_bar("looking for the board") as progress:
        for done, path in enumerate(paths):
            progress(done, len(paths))
            image = read_grey(path)
            if shape is not None and shape != image.shape:
                raise ValueError(
                    f"{path} is {image.shape[1]}x{image.shape[0]} pixels; expected {shape[1]}x{shape[0]} as the first"
                )
            shape, found = image.shape, board.find(image)
            if found is None:
                continue
            same = first.setdefault(found[1].tobytes(), path)
            if path in seen or same != path:
                raise ValueError(f"{path} shows the same photograph as {same}; give each once")
            seen[path] = found
    assert shape is not None
    return seen, (shape[1], shape[0])


def _result(names: list[str], found: Intrinsics) -> dict[str, Any]:
    """The result of the fit as a JSON object."""
    camera = found.camera
    values = (camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion)
    each = zip(names, found.rms, found.tilt, found.off, found.others, found.contradicted, strict=True)
    return {
        "photographs": len(names),
        "rms_px": float((found.rms**2).mean() ** 0.5),
        "each": [
            {
                "photograph": name,
                "rms_px": float(rms),
                "tilt_deg": float(tilt),
                "off_px": float(off),
                "others_px": float(others),
                "contradicted": bool(contradicted),
            }
            for name, rms, tilt, off, others, contradicted in each
        ],
        "values": {
            name: {"value": value, "std": float(std)}
            for name, value, std in zip(
                ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3"), values, found.std, strict=True
            )
        },
    }


def _lines(result: dict[str, Any], width: int, height: int) -> list[str]:
    """The result as lines of text."""
    return [
        *(f"no board is seen in {path}; a checkerboard must be completely visible" for path in result["without_board"]),
        f"{result['photographs']} photographs of {width}x{height} pixels, {result['rms_px']:.3f} px rms",
        *(
            f"{one['photograph']} is an outlier: its corners are {one['off_px']:.2f} px off the camera fitted to the "
            f"others, theirs {one['others_px']:.2f} px; leave it out if it is blurred, mirrored or of a bent board"
            for one in result["each"]
            if one["contradicted"]
        ),
        *(f"{name} {one['value']:.5g} ({one['std']:.2g})" for name, one in result["values"].items()),
        f"{result['file']} holds them; fill in there by hand, lengths in metres:",
        '  "aruco_dictionary": of the markers round the table, "DICT_4X4_50" say',
        '  "puck_top_above_table_m": the height of the puck\'s mark above the surface',
        '  "length_m", "width_m": of the table, from wall to wall; "goal_width_m" may stay null',
        f"then: puckpilot calibrate table VIEW... --camera {result['file']}",
    ]
