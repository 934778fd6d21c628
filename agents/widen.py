"""A network's weights for other observations, or with wider layers: what is new does not move it at first."""

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


def grown(weights: Mapping[str, Tensor], fresh: Mapping[str, Tensor]) -> dict[str, Tensor]:
    """`weights`, of layers that are at most as wide, in the shapes of a new network's weights `fresh`.

    Units that are new read as they do in `fresh`, and nothing of the old network reads them, so that its outputs stay
    (Chen and others, "Net2Net", ICLR 2016, whose new units are copies instead). ValueError for a layer that is wider.
    """
    made = dict(weights)
    for name, old in weights.items():
        new = fresh[name].detach().clone()
        if any(was > now for was, now in zip(old.shape, new.shape, strict=True)):
            raise ValueError(f"has a layer of {tuple(old.shape)}; the preset's has {tuple(new.shape)}")
        if old.ndim == 2:
            new[: old.shape[0]] = 0.0
            new[: old.shape[0], : old.shape[1]] = old
        else:
            new[: old.shape[0]] = old
        made[name] = new
    return made
