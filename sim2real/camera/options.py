"""The arguments of a command that say how a camera is set, or what pictures of it are."""

from __future__ import annotations

import argparse

from sim2real.camera.region import RegionOfInterest
from sim2real.camera.settings import CameraSettings


def add_camera_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments, from which `settings_of` makes settings."""
    group = parser.add_argument_group("the camera and its pictures")
    group.add_argument(
        "--rate", type=float, metavar="HZ", help="of a camera; of a folder's pictures (120); of a slow-motion video"
    )
    group.add_argument("--exposure", type=float, metavar="S", help="of aravis:, flir: and rendered pictures (1e-4)")
    group.add_argument("--gain", type=float, metavar="DB", help="of a camera")
    group.add_argument(
        "--trigger-line", type=int, metavar="N", help="hardware line that starts each exposure of aravis: and flir:"
    )
    group.add_argument(
        "--region", metavar="WxH+X+Y", help="of the sensor that pictures show: width, height, first column and row"
    )
    group.add_argument("--mosaic", action="store_true", help="pictures are raw, of a colour sensor (BayerRG8)")
    group.add_argument(
        "--setup-exposure", type=float, metavar="S", help="locate the camera by a full picture beforehand (8e-3, say)"
    )


def settings_of(args: argparse.Namespace) -> CameraSettings:
    """The settings by the arguments. Raises ValueError, in one line, for one that cannot be."""
    return CameraSettings(
        exposure=args.exposure,
        setup_exposure=args.setup_exposure,
        gain=args.gain,
        rate=args.rate,
        trigger_line=args.trigger_line,
        pixel_format="BayerRG8" if args.mosaic else "Mono8",
        region=None if args.region is None else RegionOfInterest.parse(args.region),
    )
