"""Intrinsics from boards: exact corners by cv2.projectPoints, and boards warped into photographs."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import cv2
import numpy as np
import pytest

import puckpilot
from sim2real.vision.calibrate.intrinsics.board import CalibrationBoard
from sim2real.vision.calibrate.intrinsics.calibrate import Intrinsics, calibrate
from tests.sim2real.vision.test_camera import CAMERA
from tests.sim2real.vision.world import DISTORTION, SIZE, K

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


def corners(
    turn: tuple[float, float, float], k: int, noise: float, rng: np.random.Generator | None = None
) -> tuple[np.ndarray, np.ndarray]:
    x, y = np.meshgrid(np.arange(COLUMNS), np.arange(ROWS))
    places = np.stack([x.ravel(), y.ravel(), 0 * x.ravel()], axis=1).astype(np.float32)
    at = motion(k, turn, 13.0)
    pixels = cv2.projectPoints(places.astype(float), at[:3], at[3:], K, DISTORTION)[0][:, 0]
    shaken = pixels + (rng or np.random.default_rng(k)).normal(0.0, noise, pixels.shape)
    return places, shaken.astype(np.float32)


def names(many: int) -> list[str]:
    return [f"{k}.png" for k in range(many)]


def z_scores(found: Intrinsics) -> np.ndarray:
    """How many of its stated deviations each of nine intrinsics is off."""
    truth = np.array([CAMERA.fx, CAMERA.fy, CAMERA.cx, CAMERA.cy, *CAMERA.distortion])
    camera = found.camera
    return (np.array([camera.fx, camera.fy, camera.cx, camera.cy, *camera.distortion]) - truth) / found.std


def test_intrinsics_lie_within_their_error_bars():
    seen = [corners(turn, k, 0.1) for k, turn in enumerate(TURNS)]
    found = calibrate(names(len(seen)), seen, SIZE)
    assert np.abs(z_scores(found)).max() < 4.0 and found.std[0] < 5.0 and found.camera.size == SIZE
    assert found.rms == pytest.approx(0.14, abs=0.03) and not found.contradicted.any()


def drawn_poses(seed: int) -> list[tuple[np.ndarray, np.ndarray]]:
    """Corners of 5 to 12 boards that are tilted by up to 0.3 to 50 degrees, all ways or all one way."""
    rng = np.random.default_rng(seed)
    steepest, way, spread = np.exp(rng.uniform(np.log(0.3), np.log(50.0))), rng.uniform(0, 6.3), rng.choice([0.2, 3.2])
    seen = []
    for k in range(rng.integers(5, 13)):
        tilt, towards = np.radians(rng.uniform(0.0, steepest)), way + rng.uniform(-spread, spread)
        turn = (tilt * np.cos(towards), tilt * np.sin(towards), rng.uniform(-0.3, 0.3))
        seen.append(corners(turn, k, 0.1, rng))
    return seen


@pytest.mark.slow
def test_whatever_the_poses_what_is_not_refused_lies_within_its_error_bars():
    """Of poses that OpenCV's own deviations would let pass, half are further off than four of these."""
    kept, refused = [], 0
    for seed in range(60):
        seen = drawn_poses(seed)
        try:
            kept.append(z_scores(calibrate(names(len(seen)), seen, SIZE)))
        except ValueError as error:
            assert "do not determine the" in str(error)
            refused += 1
    worst = np.abs(kept).max(axis=1)
    assert len(kept) > 15 and refused > 15 and (worst < 4.0).mean() >= 0.95
    assert 0.8 < np.sqrt(np.mean(np.square(kept))) < 1.2


def test_a_mirrored_photograph_contradicts_the_others():
    """Its corners are 0.3 px off, no more than a poor photograph's, but move the focal length by many deviations."""
    seen = [corners(turn, k, 0.05) for k, turn in enumerate(TURNS)]
    places, pixels = seen[3]
    seen[3] = (places, np.array([SIZE[0] - 1, 0], np.float32) + np.array([-1, 1], np.float32) * pixels)
    found = calibrate(names(7), seen, SIZE)
    assert list(np.flatnonzero(found.contradicted)) == [3] and np.abs(z_scores(found)).max() > 5.0


def test_what_the_others_say_of_a_photograph_is_what_a_fit_without_it_says():
    seen = [corners(turn, k, 0.1 + 0.1 * (k == 2)) for k, turn in enumerate(TURNS)]
    found = calibrate(names(7), seen, SIZE)
    rest = calibrate(names(6), seen[:2] + seen[3:], SIZE)
    freedom = 6 * (2 * COLUMNS * ROWS - 6) - 9
    squares = [(one.rms**2).sum() * COLUMNS * ROWS for one in (found, rest)]
    assert found.others[2] == pytest.approx(np.sqrt(2 * squares[1] / freedom), rel=1e-4)
    assert found.off[2] == pytest.approx(np.sqrt((squares[0] - squares[1]) / (COLUMNS * ROWS - 3)), rel=1e-4)


def test_the_same_photographs_give_the_same_numbers():
    """To the last bit, though they hardly tell them."""
    seen = [corners((0.1 * a, 0.1 * b, 0.1 * c), k, 0.02) for k, (a, b, c) in enumerate(TURNS * 2)]
    found = [calibrate(names(14), seen, SIZE) for _ in range(12)]
    assert len({one.camera for one in found}) == 1 and len({one.std.tobytes() for one in found}) == 1


def test_a_board_edge_on_is_named():
    seen = [corners(turn, k, 0.02) for k, turn in enumerate([*TURNS, (1.4, 0.0, 0.0)])]
    with pytest.raises(ValueError, match=r"7\.png: the board is seen edge-on, tilted by 80 degrees, 0\.\d\d px rms"):
        calibrate(names(8), seen, SIZE)


def test_a_board_with_other_corners_is_named():
    seen = [corners(turn, k, 0.02) for k, turn in enumerate(TURNS)]
    seen[4] = (seen[4][0], np.roll(seen[4][1], 5, axis=0))
    with pytest.raises(ValueError, match=r"4\.png: corners are \d+\.\d px rms from where the board has them"):
        calibrate(names(7), seen, SIZE)


@pytest.mark.parametrize(
    "turns, message",
    [
        (
            [(0.01 * k, 0.0, 0.2 * k) for k in range(6)],
            r"focal length: it is uncertain by \d+\.\d %, .* 0 to 3 degrees",
        ),
        ([(0.001, 0.0, 0.1 * k) for k in range(6)], "focal length: it is uncertain altogether, expected 1 % at most"),
        ([(0.5, 0.0, 0.0)] * 6, "focal length: it is uncertain"),
    ],
)
def test_boards_that_face_the_camera_or_all_one_way_do_not_suffice(turns: list, message: str):
    seen = [corners(turn, k, 0.1) for k, turn in enumerate(turns)]
    with pytest.raises(ValueError, match=message):
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


PINHOLE = np.array([[FOCUS, 0, 410.0], [0, FOCUS, 295.0], [0, 0, 1]])


def photographs(folder: Path, charuco: bool) -> list[str]:
    """Boards seen by a pinhole camera."""
    board = drawn(charuco)
    to_squares = np.array([[1 / PIXELS, 0, 0.5 / PIXELS - 2], [0, 1 / PIXELS, 0.5 / PIXELS - 2], [0, 0, 1]])
    paths = []
    for n, turn in enumerate(TURNS):
        at = motion(n, turn, 16.0)
        matrix = PINHOLE @ np.column_stack([cv2.Rodrigues(at[:3])[0][:, :2], at[3:]]) @ to_squares
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
    output = json.loads(capsys.readouterr().out)
    assert output["photographs"] == len(TURNS) and output["rms_px"] < 0.25
    for name, truth in {"fx": FOCUS, "fy": FOCUS, "cx": 410.0, "cy": 295.0}.items():
        assert output["values"][name]["value"] == pytest.approx(truth, abs=2.0 + 4.0 * output["values"][name]["std"])
    assert [Path(one["photograph"]).name for one in output["each"]] == [f"{k}.png" for k in range(len(TURNS))]
    assert np.sqrt(np.mean([one["rms_px"] ** 2 for one in output["each"]])) == pytest.approx(output["rms_px"])
    for one, turn in zip(output["each"], TURNS, strict=True):
        tilt = np.degrees(np.arccos(cv2.Rodrigues(np.array(turn, float))[0][2, 2]))
        assert one["tilt_deg"] == pytest.approx(tilt, abs=0.5) and not one["contradicted"]
    words = json.loads((tmp_path / "camera.json").read_text())
    assert words["image_size_px"] == list(SMALL) and words["K"][0][0] == output["values"]["fx"]["value"]
    assert words["aruco_dictionary"] is None  # the table's, which is another than the board's


@pytest.mark.parametrize("charuco, close", [(False, 0.05), (True, 0.2)])
def test_corners_are_found_where_the_board_was_drawn(tmp_path: Path, charuco: bool, close: float):
    """On average over a board, to a fraction of a pixel."""
    for n, path in enumerate(photographs(tmp_path, charuco)):
        image, at = cv2.imread(path, cv2.IMREAD_GRAYSCALE), motion(n, TURNS[n], 16.0)
        assert image is not None
        found = CalibrationBoard(COLUMNS, ROWS, "DICT_4X4_50" if charuco else None).find(image)
        assert found is not None
        there = cv2.projectPoints(found[0].astype(float), at[:3], at[3:], PINHOLE, np.zeros(5))[0][:, 0]
        turned = there[::-1]  # a checkerboard looks the same from both of its long sides
        off = min((found[1] - one for one in (there, turned)), key=lambda one: np.abs(one).mean())
        assert np.abs(off.mean(axis=0)).max() < close


@pytest.mark.slow
def test_photographs_without_a_board_are_reported(tmp_path: Path, capsys):
    paths = photographs(tmp_path, False)
    cv2.imwrite(paths[2], np.full((600, 800), 99, np.uint8))
    assert puckpilot.main(["calibrate", "camera", *paths, "--out", str(tmp_path / "camera.json")]) == 0
    assert (
        f"no board is seen in {paths[2]}; a checkerboard must be completely visible\n6 photographs of 800x600"
        in capsys.readouterr().out
    )
    assert puckpilot.main(["calibrate", "camera", *paths, "--board", "8x6"]) == 2
    assert "8x6 inner corners is seen in none of 7 photographs" in capsys.readouterr().err


def test_it_names_what_stands_out_and_what_is_to_be_filled_in(tmp_path: Path, capsys):
    paths, out = photographs(tmp_path, True), tmp_path / "new" / "camera.json"
    image = cv2.imread(paths[3], cv2.IMREAD_GRAYSCALE)
    assert image is not None
    cv2.imwrite(paths[3], cv2.resize(image, (816, 600))[:, 8:808])  # by another lens, as it were
    assert puckpilot.main(["calibrate", "camera", *paths, "--charuco", "DICT_4X4_50", "--out", str(out)]) == 0
    output = capsys.readouterr().out
    assert output.count("is an outlier") == 1 and f"\n{paths[3]} is an outlier: its corners are 0." in output
    assert "leave it out" in output
    empty = {name for name, value in flat(json.loads(out.read_text())).items() if value is None}
    assert empty == {"aruco_dictionary", "puck_top_above_table_m", "length_m", "width_m", "goal_width_m"}
    assert all(f'"{name}"' in output for name in empty)


def flat(words: dict) -> dict:
    """The same with what is inside of objects beside the rest."""
    return {k: v for key, one in words.items() for k, v in (flat(one) if isinstance(one, dict) else {key: one}).items()}


def test_what_is_there_is_not_written_over(tmp_path: Path, capsys):
    """A user has filled in a camera.json by hand."""
    (tmp_path / "camera.json").write_text("keep")
    for out in (tmp_path / "camera.json", tmp_path):
        assert puckpilot.main(["calibrate", "camera", "none.png", "--out", str(out)]) == 2
        assert f"{out} exists already; choose another name or remove it" in capsys.readouterr().err
    assert (tmp_path / "camera.json").read_text() == "keep"


@pytest.mark.parametrize("again", ["0.png", "copy.png"])
def test_a_photograph_that_is_given_twice_is_refused(tmp_path: Path, again: str, capsys):
    """It would make the deviations too small."""
    paths = photographs(tmp_path, True)
    shutil.copy(paths[0], tmp_path / "copy.png")
    words = [*paths, str(tmp_path / again), "--charuco", "DICT_4X4_50", "--out", str(tmp_path / "camera.json")]
    assert puckpilot.main(["calibrate", "camera", *words]) == 2
    assert f"{tmp_path / again} shows the same photograph as {paths[0]}; give each once" in capsys.readouterr().err


@pytest.mark.parametrize(
    "options, message",
    [
        (["--board", "9"], "--board is '9'; expected inner corners like 9x6"),
        (["--marker", "1.5"], "--marker is 1.5; expected a share of a square"),
        (["--charuco", "DICT_NONE"], "unknown dictionary of markers 'DICT_NONE'"),
    ],
)
def test_options_that_cannot_be_are_refused(tmp_path: Path, options: list[str], message: str, capsys):
    cv2.imwrite(str(tmp_path / "one.png"), np.full((600, 800), 99, np.uint8))
    assert puckpilot.main(["calibrate", "camera", str(tmp_path / "one.png"), *options]) == 2
    assert message in capsys.readouterr().err


def test_pictures_of_two_sizes_are_refused(tmp_path: Path, capsys):
    for k, size in enumerate([(600, 800), (300, 400)]):
        cv2.imwrite(str(tmp_path / f"{k}.png"), np.full(size, 99, np.uint8))
    assert puckpilot.main(["calibrate", "camera", *(str(tmp_path / f"{k}.png") for k in range(2))]) == 2
    assert "1.png is 400x300 pixels; expected 800x600 as the first" in capsys.readouterr().err


def test_a_charuco_board_may_be_partly_hidden(tmp_path: Path):
    image = cv2.imread(photographs(tmp_path, True)[0], cv2.IMREAD_GRAYSCALE)
    assert image is not None
    image[:, :330] = 150
    found = CalibrationBoard(COLUMNS, ROWS, "DICT_4X4_50").find(image)
    assert found is not None and 12 <= len(found[0]) < COLUMNS * ROWS
