"""The compiled forward pass against numpy in float64, and networks that are refused."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from agents.policy.network import Network


def layers(sizes: list[int], seed: int = 1) -> tuple[list[np.ndarray], list[np.ndarray]]:
    rng = np.random.default_rng(seed)
    weights = [rng.normal(0.0, 1.0 / np.sqrt(a), (b, a)) for a, b in itertools.pairwise(sizes)]
    biases = [rng.normal(0.0, 0.3, b) for b in sizes[1:]]
    return [w.astype(np.float32) for w in weights], [b.astype(np.float32) for b in biases]


def reference(weights: list[np.ndarray], biases: list[np.ndarray], inputs: np.ndarray) -> np.ndarray:
    x = inputs.astype(np.float64)
    for w, b in zip(weights[:-1], biases[:-1], strict=True):
        x = np.maximum(x @ w.astype(np.float64).T + b, 0.0)
    return x @ weights[-1].astype(np.float64).T + biases[-1]


@pytest.mark.parametrize("sizes", [[3, 4], [21, 128, 128, 4], [5, 1, 7, 2], [1, 1], [2, 64, 3, 64, 2]])
def test_outputs_equal_a_reference_perceptron(sizes: list[int]) -> None:
    weights, biases = layers(sizes)
    inputs = np.random.default_rng(2).normal(0.0, 1.5, (37, sizes[0])).astype(np.float32)
    expected = reference(weights, biases, inputs)
    assert (inputs < 0.0).any()  # the first layer's inputs are not rectified
    found = Network(weights, biases)(inputs)
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, expected, atol=2e-5)


def test_inputs_may_have_any_memory_order_or_no_rows() -> None:
    weights, biases = layers([6, 8, 4])
    network = Network(weights, biases)
    inputs = np.random.default_rng(3).normal(size=(6, 10))
    np.testing.assert_allclose(network(inputs.T.astype(np.float32)), reference(weights, biases, inputs.T), atol=1e-5)
    backwards = np.asfortranarray(inputs.T.astype(np.float32))[::-1]
    np.testing.assert_allclose(network(backwards), reference(weights, biases, backwards), atol=1e-5)
    assert network(np.zeros((0, 6), np.float32)).shape == (0, 4)


def test_a_decision_is_scaled_input_forward_pass_and_scaled_output() -> None:
    weights, biases = layers([5, 16, 4])
    rng = np.random.default_rng(6)
    index = np.array([2, -1, 0, 6, 5])
    reads = np.stack([rng.normal(size=5), rng.uniform(0.5, 3.0, 5)]).astype(np.float32)
    acts = np.array([[0.5, 0.5, 5.0, 5.0], [0.45, 0.4, 4.8, 9.0], [0.3, 0.05, 0.3, 0.3], [0.6, 0.95, 10.0, 7.0]])
    observations = rng.normal(0.0, 2.0, (200, 7)).astype(np.float32)
    shown = np.where(index < 0, 0.0, (observations[:, index].astype(np.float64) - reads[0]) / reads[1])
    wanted = acts[0] + acts[1] * np.tanh(reference(weights, biases, shown))
    found = Network(weights, biases).decide(observations, index, reads, acts.astype(np.float32))
    np.testing.assert_allclose(found, np.clip(wanted, acts[2], acts[3]), atol=5e-5)
    assert (wanted[:, 0] > 0.6).any() and (wanted[:, 3] > 7.0).any()


def test_outputs_are_not_overwritten_by_the_next_call() -> None:
    network = Network(*layers([2, 5, 3]))
    first = network(np.ones((4, 2), np.float32))
    kept = first.copy()
    network(np.full((4, 2), -7.0, np.float32))
    assert (first == kept).all()


def test_nan_inputs_give_nan_outputs() -> None:
    """ReLU of NaN is not 0: a broken observation must not look like a valid one."""
    inputs = np.array([[np.nan, 0.0], [0.0, 0.0]], np.float32)
    found = Network(*layers([2, 8, 8, 4]))(inputs)
    assert np.isnan(found[0]).all() and np.isfinite(found[1]).all()


def ones(*shape: int) -> np.ndarray:
    return np.ones(shape, np.float32)


@pytest.mark.parametrize(
    ("weights", "biases"),
    [
        ([], []),
        ([ones(4, 3)], []),
        ([ones(4, 3)], [ones(3)]),
        ([ones(4, 3), ones(2, 5)], [ones(4), ones(2)]),
        ([ones(4)], [ones(4)]),
        ([ones(4, 3, 2)], [ones(4)]),
        ([ones(4, 3)], [ones(4, 1)]),
        ([ones(0, 3)], [ones(0)]),
        ([ones(4, 0)], [ones(4)]),
        ([np.float32(1.0)], [ones(1)]),
    ],
)
def test_layers_of_mismatched_shapes_are_refused(weights: list, biases: list) -> None:
    with pytest.raises(ValueError, match="layer") as error:
        Network(weights, biases)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("where", ["weights", "biases"])
def test_numbers_that_are_not_finite_are_refused(where: str, bad: float) -> None:
    weights, biases = layers([3, 4, 2])
    (weights if where == "weights" else biases)[1].flat[1] = bad
    with pytest.raises(ValueError, match="layer 1 holds numbers that are not finite"):
        Network(weights, biases)
