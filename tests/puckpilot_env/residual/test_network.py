"""The network of residuals: sums by hand, a file that holds it, files that are refused in one line."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from puckpilot_env.residual.network import INPUTS, OUTPUTS, Residual, load_residual


def network(seed: int = 0) -> Residual:
    rng = np.random.default_rng(seed)
    shapes = [(7, len(INPUTS)), (len(OUTPUTS), 7)]
    sizes = [len(INPUTS), len(INPUTS), len(OUTPUTS), len(OUTPUTS), len(OUTPUTS)]
    scales = [rng.uniform(0.5, 2.0, size).astype(np.float32) for size in sizes]
    weights = [rng.normal(size=shape).astype(np.float32) for shape in shapes]
    return Residual(weights, [rng.normal(size=shape[0]).astype(np.float32) for shape in shapes], *scales)


def test_a_correction_is_the_sum_done_by_hand_within_its_bound() -> None:
    one, inputs = network(), np.random.default_rng(1).normal(size=(20, len(INPUTS)))
    wide = replace(one, bound=np.full(4, 1e3, np.float32))
    for row, free, bounded in zip(inputs, wide(inputs), one(inputs), strict=True):
        hidden = [
            np.tanh(b + sum(w[j] * (row[j] - one.centre[j]) / one.span[j] for j in range(len(row))))
            for w, b in zip(one.weights[0], one.biases[0], strict=True)
        ]
        for k in range(4):
            output = one.biases[1][k] + sum(w * h for w, h in zip(one.weights[1][k], hidden, strict=True))
            by_hand = one.middle[k] + one.scale[k] * output
            assert free[k] == pytest.approx(by_hand, abs=1e-4)
            assert bounded[k] == pytest.approx(min(max(by_hand, -one.bound[k]), one.bound[k]), abs=1e-4)
    assert one(inputs).dtype == np.float32 and (np.abs(wide(inputs)) > one.bound).any()


def test_a_file_holds_the_network(tmp_path: Path) -> None:
    one, inputs = network(), np.random.default_rng(1).normal(size=(9, len(INPUTS)))
    again = load_residual(one.save(tmp_path / "net.npz"))
    assert again(inputs).tobytes() == one(inputs).tobytes()
    assert [path.name for path in tmp_path.iterdir()] == ["net.npz"]


BROKEN = {
    "not there": (None, "is not there"),
    "cut short": (lambda arrays: 200, "is no network of residuals, or is truncated"),
    "pickled": (lambda arrays: arrays | {"span": np.array([{}], object)}, "is no network of residuals"),
    "another format": (lambda arrays: arrays | {"head": np.array('{"format": "puckpilot-policy-1"}')}, "format"),
    "an array too many": (lambda arrays: arrays | {"more": np.zeros(3, np.float32)}, "it holds 10 arrays"),
    "no span": (lambda arrays: arrays | {"span": np.zeros(18, np.float32)}, "no 0 as a span"),
    "not finite": (lambda arrays: arrays | {"biases_0": np.full(7, np.nan, np.float32)}, "not finite"),
    "layers that do not meet": (lambda arrays: arrays | {"weights_1": np.ones((4, 6), np.float32)}, "layer 1 has"),
    "doubles": (lambda arrays: arrays | {"centre": np.zeros(18)}, "float32"),
}


@pytest.mark.parametrize("wrong", BROKEN)
def test_a_broken_file_is_refused_in_one_line(wrong: str, tmp_path: Path) -> None:
    path = network().save(tmp_path / "net.npz")
    change, reason = BROKEN[wrong]
    with np.load(path) as file:
        changed = change({name: file[name] for name in file.files}) if change else None
    if changed is None:
        path.unlink()
    elif isinstance(changed, int):
        path.write_bytes(path.read_bytes()[:changed])
    else:
        np.savez(path, **changed)
    with pytest.raises(ValueError, match=reason) as error:
        load_residual(path)
    assert str(error.value).startswith(f"{path}: ") and "\n" not in str(error.value)
