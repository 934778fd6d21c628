"""Settings of a camera and regions of its sensor: what cannot be is refused in one line."""

from __future__ import annotations

import argparse
from dataclasses import replace
from typing import Any

import pytest

from sim2real.camera.frame import CameraError
from sim2real.camera.options import add_camera_arguments, settings_of
from sim2real.camera.region import RegionOfInterest
from sim2real.camera.settings import CameraSettings

REGION = RegionOfInterest(396, 20, 1300, 1450)


def test_a_region_is_read_as_it_is_written() -> None:
    assert RegionOfInterest.parse("1300x1450+396+20") == REGION
    assert str(REGION) == "1300x1450+396+20" and REGION.size == (1300, 1450)
    REGION.check_within((2048, 1536))
    with pytest.raises(ValueError, match="reaches beyond the 1440x1080 pixels for which the camera is calibrated"):
        REGION.check_within((1440, 1080))


@pytest.mark.parametrize("word", ["", "1300x1450", "1300x1450+396", "-1x5+0+0", "0x5+0+0", "1x1+1+1+1", "9" * 80])
def test_what_is_no_region_is_refused(word: str) -> None:
    with pytest.raises(ValueError, match="expected WIDTHxHEIGHT") as error:
        RegionOfInterest.parse(word)
    assert "\n" not in str(error.value) and len(str(error.value)) < 200


@pytest.mark.parametrize(
    "wrong",
    [
        {"exposure": 0.0}, {"setup_exposure": float("nan")}, {"rate": -1.0}, {"gain": 99.0}, {"gain": float("nan")},
        {"trigger_line": 16}, {"pixel_format": "RGB8"},
    ],
)  # fmt: skip
def test_what_cannot_be_set_is_refused(wrong: dict[str, Any]) -> None:
    (name,) = wrong
    with pytest.raises(CameraError, match=f"{name} is .*; expected"):
        CameraSettings(**wrong)


def test_the_setup_picture_shows_the_whole_sensor() -> None:
    play = CameraSettings(1e-4, 8e-3, 25.0, 120.0, 3, "BayerRG8", REGION)
    setup = play.for_setup((2048, 1536))
    assert setup == CameraSettings(8e-3, gain=25.0, pixel_format="BayerRG8", region=RegionOfInterest(0, 0, 2048, 1536))


def test_arguments_make_settings() -> None:
    parser = argparse.ArgumentParser()
    add_camera_arguments(parser)
    assert settings_of(parser.parse_args([])) == CameraSettings()
    words = "--rate 120 --exposure 1e-4 --gain 25 --trigger-line 3 --region 1300x1450+396+20 --mosaic"
    play = CameraSettings(1e-4, None, 25.0, 120.0, 3, "BayerRG8", REGION)
    assert settings_of(parser.parse_args(words.split())) == play
    assert settings_of(parser.parse_args([*words.split(), "--setup-exposure", "8e-3"])) == replace(
        play, setup_exposure=8e-3
    )
