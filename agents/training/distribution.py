"""A tanh-squashed normal distribution: actions stay inside -1 to 1 (report K.1, with its errata)."""

from __future__ import annotations

import math

import torch
from rsl_rl.modules.distribution import Distribution
from torch import Tensor, nn
from torch.nn.functional import softplus

LEAST_SCALE, MOST_SCALE = 0.001, 0.5
EDGE = 1.0 - 1e-6  # outputs are clamped to this, where float32 still differs from 1
# Gauss-Hermite for the expectation over a standard normal: exact for polynomials up to degree 9.
_NODES = (-2.856970013872806, -1.355626179974266, 0.0, 1.355626179974266, 2.856970013872806)
_WEIGHTS = (0.011257411327720691, 0.22207592200561266, 0.5333333333333333, 0.22207592200561266, 0.011257411327720691)


class TanhNormal(Distribution):
    """tanh of a normal variable with mean `loc` and standard deviation `scale`, both predicted for each output.

    The network's output is (..., 2, output_dim): loc, and a raw number whose sigmoid maps to a scale from 0.001 to 0.5.
    The report's own formula, sigmoid(raw) - 0.5 + 0.001, is negative for half of all raw numbers.
    """

    def __init__(self, output_dim: int, init_scale: float = 0.4) -> None:
        """`init_scale`: the scale of an untrained network. ValueError unless it is between 0.001 and 0.5."""
        super().__init__(output_dim)
        if not LEAST_SCALE < init_scale < MOST_SCALE:
            raise ValueError(f"init_scale is {init_scale!r}; expected a number between {LEAST_SCALE} and {MOST_SCALE}")
        self.init_scale = init_scale
        self._loc = self._scale = torch.zeros(0)

    def update(self, mlp_output: Tensor) -> None:
        """Set the parameters from the network's output (..., 2, output_dim)."""
        self._loc, raw = torch.unbind(mlp_output, dim=-2)
        self._scale = LEAST_SCALE + (MOST_SCALE - LEAST_SCALE) * torch.sigmoid(raw)

    def sample(self) -> Tensor:
        """Random outputs (..., output_dim) inside (-1, 1)."""
        normal = self._loc + self._scale * torch.randn_like(self._loc)
        return torch.tanh(normal).clamp(-EDGE, EDGE)

    def deterministic_output(self, mlp_output: Tensor) -> Tensor:
        """The median: tanh(loc)."""
        return torch.tanh(mlp_output[..., 0, :])

    def as_deterministic_output_module(self) -> nn.Module:
        """`deterministic_output` as a module, for an exported network."""
        return _Median()

    @property
    def input_dim(self) -> list[int]:
        """Shape of the network's output, without batch dimensions."""
        return [2, self.output_dim]

    @property
    def mean(self) -> Tensor:
        """The median, tanh(loc), which a deterministic player plays."""
        return torch.tanh(self._loc)

    @property
    def std(self) -> Tensor:
        """Standard deviation before tanh."""
        return self._scale

    @property
    def entropy(self) -> Tensor:
        """Differential entropy, summed over the outputs: that of the normal variable plus E[log tanh'].

        The expectation is a Gauss-Hermite sum of five terms (error below 0.002 for scales up to 0.5).
        """
        slope = torch.zeros_like(self._loc)
        for node, weight in zip(_NODES, _WEIGHTS, strict=True):
            slope = slope + weight * _log_slope(self._loc + node * self._scale)
        return (0.5 * math.log(2.0 * math.pi * math.e) + torch.log(self._scale) + slope).sum(dim=-1)

    @property
    def params(self) -> tuple[Tensor, ...]:
        """(loc, scale) before tanh."""
        return self._loc, self._scale

    def log_prob(self, outputs: Tensor) -> Tensor:
        """Log density of outputs in (-1, 1), summed over the last dimension."""
        normal = torch.atanh(outputs.clamp(-EDGE, EDGE))
        z = (normal - self._loc) / self._scale
        density = -0.5 * z * z - torch.log(self._scale) - 0.5 * math.log(2.0 * math.pi)
        return (density - _log_slope(normal)).sum(dim=-1)

    def kl_divergence(self, old_params: tuple[Tensor, ...], new_params: tuple[Tensor, ...]) -> Tensor:
        """KL(old || new), summed over the outputs.

        That of the normal variables: tanh is invertible and leaves it as it is.
        """
        (old, old_scale), (new, new_scale) = old_params, new_params
        ratio = (old_scale / new_scale) ** 2
        return 0.5 * (ratio - 1.0 - torch.log(ratio) + ((old - new) / new_scale) ** 2).sum(dim=-1)

    def init_mlp_weights(self, mlp: nn.Module) -> None:
        """Initialize the last layer so that every scale is `init_scale` and every median is near 0."""
        last = [layer for layer in mlp.modules() if isinstance(layer, nn.Linear)][-1]
        share = (self.init_scale - LEAST_SCALE) / (MOST_SCALE - LEAST_SCALE)
        with torch.no_grad():
            last.weight.mul_(0.01)
            last.bias[: self.output_dim] = 0.0
            last.bias[self.output_dim :] = math.log(share / (1.0 - share))


class _Median(nn.Module):
    def forward(self, mlp_output: Tensor) -> Tensor:
        return torch.tanh(mlp_output[..., 0, :])


def _log_slope(normal: Tensor) -> Tensor:
    """log(1 - tanh(x)^2), numerically stable for large |x|."""
    return 2.0 * (math.log(2.0) - normal - softplus(-2.0 * normal))
