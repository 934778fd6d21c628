"""A network's weights for other observations: what it never saw does not move it at first, what is gone no more."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from torch import Tensor, zeros

FIRST = "mlp.0.weight"  # rsl-rl's name of the first layer's weights (outputs, inputs)


def widened(
    weights: Mapping[str, Tensor], known: Sequence[str], wanted: Sequence[str], inputs: int
) -> dict[str, Tensor]:
    """The weights of a network made for the columns `known`, for the columns `wanted`, by name, and `inputs` in all.
    Columns that are gone are dropped, as if the middle of their range were read, which is how a policy plays without
    them. Inputs after the columns, such as what only a critic sees, stay the first after them."""
    old = weights[FIRST]
    more = old.shape[1] - len(known)
    if len(wanted) + more > inputs:
        raise ValueError(
            f"the network to begin with has {more} inputs beside its columns; expected {inputs - len(wanted)} at most, "
            "as this preset's has"
        )
    new = zeros(old.shape[0], inputs, dtype=old.dtype)
    for column, name in enumerate(known):
        if name in wanted:
            new[:, wanted.index(name)] = old[:, column]
    new[:, len(wanted) : len(wanted) + more] = old[:, len(known) :]
    return {**weights, FIRST: new}
