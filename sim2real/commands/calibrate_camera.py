"""A camera's intrinsics from photographs of a flat board, a dozen from all sides, tilted by 20 to 45 degrees.

The board fills the picture now here, now there, up to its corners. Writes camera.json; fill in there what the table's
calibration must know besides: the table's size and the height of the puck's mark.
"""

from __future__ import annotations

import argparse
import json
import re
from pathlib import Path

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
    """0: calibrated. Raises ValueError, in one line, for what cannot be."""
    from puckpilot_env.whole_file import check_folder
    from sim2real.camera.grey_image import read_grey
    from sim2real.vision.calibrate.board import Board
    from sim2real.vision.calibrate.intrinsics import calibrate
    from sim2real.vision.camera_file import write_camera

    size = re.fullmatch(r"(\d{1,2})x(\d{1,2})", args.board)
    if size is None or min(int(size[1]), int(size[2])) < 3:
        raise ValueError(f"--board is '{args.board}'; expected inner corners like {BOARD}, 3 at least each way")
    if not 0.1 <= args.marker < 1.0:
        raise ValueError(f"--marker is {args.marker:g}; expected a share of a square from 0.1 to below 1")
    check_folder(args.out.absolute().parent)
    board = Board(int(size[1]), int(size[2]), args.charuco, args.marker)
    names, seen, without, shape = [], [], [], None
    for path in args.images:
        image = read_grey(path)
        if shape not in (None, image.shape):
            raise ValueError(
                f"{path} is {image.shape[1]}x{image.shape[0]} pixels; expected {shape[1]}x{shape[0]} as the first"
            )
        shape, found = image.shape, board.find(image)
        if found is None:
            without.append(str(path))
        else:
            names.append(str(path))
            seen.append(found)
    assert shape is not None
    if not seen:
        raise ValueError(
            f"a board of {args.board} inner corners is seen in none of {len(args.images)} photographs; see --board"
        )
    found = calibrate(names, seen, (shape[1], shape[0]))
    camera = found.camera
    told = {
        "file": str(args.out),
        "photographs": len(seen),
        "without_board": without,
        "rms_px": float((found.rms**2).mean() ** 0.5),
        "values": {
            name: {"value": value, "std": float(std)}
            for (name, value), std in zip(_values(camera), found.std, strict=True)
        },
    }
    write_camera(args.out, camera, args.charuco, f"rms {told['rms_px']:.3f} px over {len(seen)} photographs")
    if args.json:
        print(json.dumps(told, indent=1, allow_nan=False))
        return 0
    for path in without:
        print(f"no board is seen in {path}")
    print(f"{len(seen)} photographs of {shape[1]}x{shape[0]} pixels, {told['rms_px']:.3f} px rms")
    for name, one in told["values"].items():
        print(f"{name} {one['value']:.5g} ({one['std']:.2g})")
    print(
        f"{args.out} holds them; fill in the null values, then: puckpilot calibrate table VIEW... --camera {args.out}"
    )
    return 0


def _values(camera) -> list[tuple[str, float]]:
    names = ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2", "k3")
    return list(zip(names, (camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion), strict=True))
