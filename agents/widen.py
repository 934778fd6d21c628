"""A network's weights for observations that show more: what it never saw does not move it at first."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from torch import Tensor, zeros

FIRST = "mlp.0.weight"  # rsl-rl's name of the first layer's weights (outputs, inputs)


def widened(
    weights: Mapping[str, Tensor], known: Sequence[str], wanted: Sequence[str], inputs: int
) -> dict[str, Tensor]:
    """The weights of a network made for the columns `known`, for the columns `wanted`, which have all of them, by name,
    and `inputs` in all. Inputs after the columns, such as what only a critic sees, stay the first after them.
    ValueError for columns that are gone."""
    gone = [name for name in known if name not in wanted]
    if gone:
        raise ValueError(f"the network reads {', '.join(gone)}, which this variant does not show")
    old = weights[FIRST]
    more = old.shape[1] - len(known)
    if len(wanted) + more > inputs:
        raise ValueError(f"the network has {more} inputs beside its columns; expected {inputs - len(wanted)} at most")
    new = zeros(old.shape[0], inputs, dtype=old.dtype)
    new[:, [wanted.index(name) for name in known]] = old[:, : len(known)]
    new[:, len(wanted) : len(wanted) + more] = old[:, len(known) :]
    return {**weights, FIRST: new}
