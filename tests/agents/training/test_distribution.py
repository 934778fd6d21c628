"""The tanh-squashed normal, checked against torch's transformed distribution and against sums over its samples."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
import torch
from scipy.special import ndtri
from torch import Tensor, nn
from torch.distributions import Normal, TransformedDistribution, kl_divergence
from torch.distributions.transforms import TanhTransform

from agents.training.distribution import EDGE, LEAST_SCALE, MOST_SCALE, TanhNormal

LOCS = (-4.0, -1.5, -0.3, 0.0, 0.8, 2.5)
SCALES = (0.0011, 0.02, 0.2, 0.4, 0.4999)


def raw_of(scale: Tensor) -> Tensor:
    """The network's number for a scale."""
    return torch.logit((scale - 0.001) / 0.499)


def made(loc: Tensor, scale: Tensor) -> TanhNormal:
    distribution = TanhNormal(loc.shape[-1])
    distribution.update(torch.stack([loc, raw_of(scale)], dim=-2))
    return distribution


def transformed(loc: Tensor, scale: Tensor) -> TransformedDistribution:
    return TransformedDistribution(Normal(loc, scale), [TanhTransform(cache_size=1)])


def grid() -> tuple[Tensor, Tensor]:
    """(pairs, 1) of every loc with every scale, float64."""
    pairs = torch.tensor(list(itertools.product(LOCS, SCALES)), dtype=torch.float64)
    return pairs[:, :1], pairs[:, 1:]


def test_log_prob_is_the_transformed_distribution_s() -> None:
    torch.manual_seed(1)
    loc, scale = torch.randn(200, 4, dtype=torch.float64), 0.002 + 0.49 * torch.rand(200, 4, dtype=torch.float64)
    outputs = torch.tanh(loc + scale * torch.randn(200, 4, dtype=torch.float64))
    found = made(loc, scale).log_prob(outputs)
    assert found.shape == (200,)
    torch.testing.assert_close(found, transformed(loc, scale).log_prob(outputs).sum(-1), rtol=1e-6, atol=1e-6)


def test_densities_add_up_to_one() -> None:
    edges = torch.linspace(-1.0, 1.0, 400_001, dtype=torch.float64)
    middles = 0.5 * (edges[1:] + edges[:-1])
    for loc, scale in ((0.0, 0.5 - 1e-6), (0.9, 0.3), (-0.4, 0.05)):
        place = torch.full((len(middles), 1), 1.0, dtype=torch.float64)
        total = made(loc * place, scale * place).log_prob(middles[:, None]).exp().mean() * 2.0
        assert float(total) == pytest.approx(1.0, abs=1e-4)


def test_entropy_is_the_mean_of_minus_the_log_density() -> None:
    """Over 200,000 samples at even shares of probability, which have a smaller error than random ones."""
    loc, scale = grid()
    normal = torch.from_numpy(ndtri((np.arange(200_000) + 0.5) / 200_000))
    for at, width in zip(loc, scale, strict=True):
        inside = at + width * normal
        density = Normal(at, width).log_prob(inside) - TanhTransform().log_abs_det_jacobian(inside, torch.tanh(inside))
        found = made(at[None], width[None]).entropy
        assert found.shape == (1,)
        assert float(found) == pytest.approx(-float(density.mean()), abs=2e-3), (at, width)


def test_entropy_is_summed_over_the_outputs() -> None:
    loc, scale = (numbers.reshape(1, -1) for numbers in grid())
    parts = sum(made(loc[:, k : k + 1], scale[:, k : k + 1]).entropy for k in range(loc.shape[1]))
    torch.testing.assert_close(made(loc, scale).entropy, parts)


def test_kl_is_that_of_the_normal_numbers() -> None:
    torch.manual_seed(2)
    loc, scale = grid()
    other, wide = loc + torch.randn_like(loc), scale.flip(0)
    found = TanhNormal(1).kl_divergence((loc, scale), (other, wide))
    expected = kl_divergence(Normal(loc, scale), Normal(other, wide)).sum(-1)
    torch.testing.assert_close(found, expected, rtol=1e-9, atol=1e-9)
    assert not torch.allclose(found, TanhNormal(1).kl_divergence((other, wide), (loc, scale)))


def test_samples_have_the_moments_and_stay_inside() -> None:
    torch.manual_seed(3)
    rows = torch.ones(100_000, 1)
    loc, scale = torch.tensor([0.0, 0.7, -20.0, 20.0]) * rows, torch.tensor([0.3, 0.1, 0.49, 0.49]) * rows
    outputs = made(loc, scale).sample()
    assert outputs.shape == loc.shape and float(outputs.abs().max()) < 1.0
    normal = torch.atanh(outputs[:, :2])
    torch.testing.assert_close(normal.mean(0), loc[0, :2], rtol=0.0, atol=5e-3)
    torch.testing.assert_close(normal.std(0), scale[0, :2], rtol=0.02, atol=0.0)
    assert np.corrcoef(normal.T)[0, 1] == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize("raw", [-1e4, -30.0, 0.0, 30.0, 1e4])
def test_the_scale_stays_within_its_bounds(raw: float) -> None:
    distribution = TanhNormal(4)
    distribution.update(torch.tensor([[0.0] * 4, [raw] * 4]))
    scale = distribution.std
    assert bool(((scale >= 0.001 - 1e-9) & (scale <= 0.5 + 1e-7)).all())
    assert float(scale[0]) == pytest.approx(0.001 + 0.499 / (1.0 + math.exp(-max(min(raw, 500.0), -500.0))), rel=1e-5)
    assert bool(torch.isfinite(distribution.entropy)) and bool(torch.isfinite(distribution.sample()).all())


@pytest.mark.parametrize("output", [1.0, -1.0, EDGE, -EDGE, 1.0 - 1e-7])
@pytest.mark.parametrize("loc", [-1e3, -3.0, 0.0, 3.0, 1e3])
def test_gradients_are_finite_where_actions_saturate(loc: float, output: float) -> None:
    network = torch.tensor([[loc] * 2, [-2.0] * 2], requires_grad=True)
    distribution = TanhNormal(2)
    distribution.update(network)
    density, entropy = distribution.log_prob(torch.full((2,), output)), distribution.entropy
    assert bool(torch.isfinite(density)) and bool(torch.isfinite(entropy))
    (density + entropy).backward()
    assert network.grad is not None and bool(torch.isfinite(network.grad).all())


def test_without_exploration_it_does_the_median() -> None:
    distribution, outputs = TanhNormal(3), torch.randn(50, 2, 3)
    distribution.update(outputs)
    expected = torch.from_numpy(np.tanh(outputs[:, 0].double().numpy())).float()
    for found in (
        distribution.deterministic_output(outputs),
        distribution.as_deterministic_output_module()(outputs),
        distribution.mean,
    ):
        torch.testing.assert_close(found, expected, rtol=1e-6, atol=1e-6)


def test_an_untrained_network_has_the_initial_scale() -> None:
    torch.manual_seed(4)
    distribution = TanhNormal(4, init_scale=0.15)
    assert distribution.input_dim == [2, 4]
    mlp = nn.Sequential(nn.Linear(10, 32), nn.ReLU(), nn.Linear(32, 8), nn.Unflatten(-1, (2, 4)))
    distribution.init_mlp_weights(mlp)
    distribution.update(mlp(torch.randn(500, 10)))
    assert bool((distribution.mean.abs() < 0.05).all())
    torch.testing.assert_close(distribution.std, torch.full((500, 4), 0.15), rtol=0.05, atol=0.0)


@pytest.mark.parametrize("scale", [0.0, -0.1, LEAST_SCALE, MOST_SCALE, 2.0, math.nan])
def test_a_scale_out_of_bounds_is_refused(scale: float) -> None:
    with pytest.raises(ValueError, match=r"init_scale is .*; expected a number between 0\.001 and 0\.5"):
        TanhNormal(4, init_scale=scale)
