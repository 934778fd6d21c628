"""Intrinsics from boards: exact corners by cv2.projectPoints, and boards warped into photographs."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

import puckpilot
from sim2real.vision.calibrate.board import Board
from sim2real.vision.calibrate.intrinsics import calibrate
from tests.sim2real.vision.test_camera import CAMERA
from tests.sim2real.vision.world import BENT, SIZE, K

COLUMNS, ROWS, PIXELS = 9, 6, 60  # inner corners, and the size of a square in the drawn board
SMALL, FOCUS = (800, 600), 900.0
TURNS = [
    (0.5, 0.1, 0),
    (-0.5, 0.2, 0.3),
    (0.1, 0.55, -0.2),
    (0.2, -0.5, 0.1),
    (-0.35, -0.35, 0.4),
    (0.4, 0.4, -0.3),
    (0.0, 0.1, 1.4),
]


def motion(k: int, turn: tuple[float, float, float], away: float) -> np.ndarray:
    """A motion (6,) that shows a board, in squares, tilted, near the middle of a picture."""
    middle = np.array([(COLUMNS - 1) / 2, (ROWS - 1) / 2, 0.0])
    shift = np.array([0.8 * np.cos(2.1 * k), 0.5 * np.sin(2.1 * k), away])
    return np.concatenate([turn, shift - cv2.Rodrigues(np.array(turn, float))[0] @ middle])


def corners(turn: tuple[float, float, float], k: int, noise: float) -> tuple[np.ndarray, np.ndarray]:
    x, y = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
    places = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1).astype(np.float32)
    at = motion(k, turn, 13.0)
    pixels = cv2.projectPoints(places.astype(float), at[:3], at[3:], K, BENT)[0][:, 0]
    return places, (pixels + np.random.default_rng(k).normal(0.0, noise, pixels.shape)).astype(np.float32)


def names(many: int) -> list[str]:
    return [f"{k}.png" for k in range(many)]


def test_intrinsics_lie_within_their_error_bars():
    seen = [corners(turn, k, 0.1) for k, turn in enumerate(TURNS)]
    found = calibrate(names(len(seen)), seen, SIZE)
    truth = np.array([CAMERA.fx, CAMERA.fy, CAMERA.cx, CAMERA.cy, *CAMERA.distortion])
    camera = found.camera
    z = (np.array([camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion]) - truth) / found.std
    assert np.abs(z).max() < 4.0 and found.std[0] < 5.0 and camera.size == SIZE
    assert found.rms == pytest.approx(0.14, abs=0.03)


def test_a_board_edge_on_is_named():
    seen = [corners(turn, k, 0.02) for k, turn in enumerate([*TURNS, (1.4, 0.0, 0.0)])]
    with pytest.raises(ValueError, match=r"7\.png: the board is seen edge-on, tilted by 80 degrees, 0\.\d\d px rms"):
        calibrate(names(8), seen, SIZE)


def test_a_board_with_other_corners_is_named():
    seen = [corners(turn, k, 0.02) for k, turn in enumerate(TURNS)]
    seen[4] = (seen[4][0], np.roll(seen[4][1], 5, axis=0))
    with pytest.raises(ValueError, match=r"4\.png: corners are \d+\.\d px rms from where the board has them"):
        calibrate(names(7), seen, SIZE)


def test_boards_that_face_the_camera_do_not_suffice():
    seen = [corners((0.01 * k, 0.0, 0.2 * k), k, 0.1) for k in range(6)]
    with pytest.raises(ValueError, match=r"focal length is uncertain by \d+ %, tilts are 0 to 3 degrees"):
        calibrate(names(6), seen, SIZE)


def test_too_few_photographs_are_counted():
    with pytest.raises(ValueError, match="seen in 4 photographs; expected 5 at least"):
        calibrate(names(4), [corners(turn, k, 0.1) for k, turn in enumerate(TURNS[:4])], SIZE)


def drawn(charuco: bool) -> np.ndarray:
    """The board, a square of white round it, its first inner corner at 2 squares from the picture's corner."""
    size = (COLUMNS + 1, ROWS + 1)
    if charuco:
        book = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
        board = cv2.aruco.CharucoBoard(size, 1.0, 0.75, book)
        return board.generateImage(((size[0] + 2) * PIXELS, (size[1] + 2) * PIXELS), marginSize=PIXELS)
    x, y = np.meshgrid(np.arange(size[0] * PIXELS) // PIXELS, np.arange(size[1] * PIXELS) // PIXELS)
    return np.pad(np.where((x + y) % 2, 230, 30).astype(np.uint8), PIXELS, constant_values=230)


def photographs(folder: Path, charuco: bool) -> list[str]:
    """Boards seen by a pinhole camera."""
    k = np.array([[FOCUS, 0, 410.0], [0, FOCUS, 295.0], [0, 0, 1]])
    board = drawn(charuco)
    to_squares = np.array([[1 / PIXELS, 0, 0.5 / PIXELS - 2], [0, 1 / PIXELS, 0.5 / PIXELS - 2], [0, 0, 1]])
    paths = []
    for n, turn in enumerate(TURNS):
        at = motion(n, turn, 16.0)
        matrix = k @ np.column_stack([cv2.Rodrigues(at[:3])[0][:, :2], at[3:]]) @ to_squares
        large = np.diag([4.0, 4.0, 1.0]) + np.array([[0, 0, 1.5], [0, 0, 1.5], [0, 0, 0]])
        image = cv2.warpPerspective(board, large @ matrix, (4 * SMALL[0], 4 * SMALL[1]), borderValue=(150,))
        image = cv2.GaussianBlur(cv2.resize(image, SMALL, interpolation=cv2.INTER_AREA), (0, 0), 0.6)
        paths.append(str(folder / f"{n}.png"))
        cv2.imwrite(paths[-1], image)
    return paths


@pytest.mark.parametrize("charuco", [False, True])
def test_the_command_finds_boards_and_writes_the_camera(tmp_path: Path, charuco: bool, capsys):
    words = [*photographs(tmp_path, charuco), "--out", str(tmp_path / "camera.json"), "--json"]
    assert puckpilot.main(["calibrate", "camera", *words, *(["--charuco", "DICT_4X4_50"] if charuco else [])]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["photographs"] == len(TURNS) and told["rms_px"] < 0.25
    for name, truth in {"fx": FOCUS, "fy": FOCUS, "cx": 410.0, "cy": 295.0}.items():
        assert told["values"][name]["value"] == pytest.approx(truth, abs=2.0 + 4.0 * told["values"][name]["std"])
    words = json.loads((tmp_path / "camera.json").read_text())
    assert words["image_size_px"] == list(SMALL) and words["K"][0][0] == told["values"]["fx"]["value"]


def test_photographs_without_a_board_are_told(tmp_path: Path, capsys):
    paths = photographs(tmp_path, False)
    cv2.imwrite(paths[2], np.full((600, 800), 99, np.uint8))
    assert puckpilot.main(["calibrate", "camera", *paths, "--out", str(tmp_path / "camera.json")]) == 0
    assert f"no board is seen in {paths[2]}\n6 photographs of 800x600" in capsys.readouterr().out
    assert puckpilot.main(["calibrate", "camera", *paths, "--board", "8x6"]) == 2
    assert "8x6 inner corners is seen in none of 7 photographs" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options, told",
    [
        (["--board", "9"], "--board is '9'; expected inner corners like 9x6"),
        (["--marker", "1.5"], "--marker is 1.5; expected a share of a square"),
        (["--charuco", "DICT_NONE"], "unknown dictionary of markers 'DICT_NONE'"),
    ],
)
def test_options_that_cannot_be_are_refused(tmp_path: Path, options: list[str], told: str, capsys):
    cv2.imwrite(str(tmp_path / "one.png"), np.full((600, 800), 99, np.uint8))
    assert puckpilot.main(["calibrate", "camera", str(tmp_path / "one.png"), *options]) == 2
    assert told in capsys.readouterr().err


def test_pictures_of_two_sizes_are_refused(tmp_path: Path, capsys):
    for k, size in enumerate([(600, 800), (300, 400)]):
        cv2.imwrite(str(tmp_path / f"{k}.png"), np.full(size, 99, np.uint8))
    assert puckpilot.main(["calibrate", "camera", *(str(tmp_path / f"{k}.png") for k in range(2))]) == 2
    assert "1.png is 400x300 pixels; expected 800x600 as the first" in capsys.readouterr().err


def test_a_charuco_board_may_be_partly_hidden(tmp_path: Path):
    image = cv2.imread(photographs(tmp_path, True)[0], cv2.IMREAD_GRAYSCALE)
    assert image is not None
    image[:, :330] = 150
    found = Board(COLUMNS, ROWS, "DICT_4X4_50").find(image)
    assert found is not None and 12 <= len(found[0]) < COLUMNS * ROWS
