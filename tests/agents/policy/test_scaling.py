"""Scaling of observations and actions, checked against tables mirrored by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from agents.policy.scaling import ACTION_MIRROR_SIGNS, InputMapping, Scaling
from puckpilot_env.tables import Tables
from tests.agents.policy.mirrored_tables import mirrored_left_right, observed, random_actions

VARIANTS = ("match-v0", "match-randomized-v0", "defence-v0", "match-sensors-v0")


def names(tables: Tables) -> list[str]:
    return [column.name for column in tables.observation_columns]


def played(variant: str, steps: int = 4) -> Tables:
    """Tables of the stated width, about whose middle a network mirrors, some random steps into their games."""
    tables, rng = Tables(variant, 12, seed=3, parameters={"width": 1.0}), np.random.default_rng(5)
    for _ in range(steps):
        tables.step(random_actions(tables, rng))
    return tables


@pytest.mark.parametrize("variant", VARIANTS)
def test_mirroring_inputs_equals_observing_the_mirrored_table(variant: str) -> None:
    tables = played(variant)
    scaling = Scaling.from_tables(tables)
    mirrored = observed(tables, mirrored_left_right(tables))
    np.testing.assert_allclose(observed(tables, tables.snapshot()), tables.observations, atol=1e-6)
    assert np.abs(mirrored - tables.observations).max() > 0.1
    for player in range(2):
        seen = scaling.normalize(tables.observations[:, player])
        np.testing.assert_allclose(seen * scaling.mirror_signs, scaling.normalize(mirrored[:, player]), atol=2e-6)


def test_mirroring_actions_equals_playing_on_the_mirrored_table() -> None:
    """A step on the mirrored tables with mirrored actions leads to the mirror image of what a step leads to."""
    tables = played("match-v0", steps=2)
    mirrored, scaling = Tables("match-v0", len(tables)), Scaling.from_tables(tables)
    mirrored.restore(mirrored_left_right(tables))
    outputs = np.random.default_rng(8).uniform(-1.0, 1.0, (2 * len(tables), 4)).astype(np.float32)
    tables.step(scaling.to_actions(outputs).reshape(-1, 2, 4))
    mirrored.step(scaling.to_actions(outputs * np.array(ACTION_MIRROR_SIGNS, np.float32)).reshape(-1, 2, 4))
    undisturbed = ~(tables.terminated | (tables.states["held"] == 0.0))  # neither ended nor reset
    assert undisturbed.sum() > 6
    np.testing.assert_allclose(
        observed(tables, mirrored_left_right(tables))[undisturbed], mirrored.observations[undisturbed], atol=1e-4
    )


@pytest.mark.parametrize("variant", VARIANTS)
def test_observation_bounds_are_scaled_to_one(variant: str) -> None:
    tables = Tables(variant, 1)
    scaling = Scaling.from_tables(tables)
    low, high = (scaling.normalize(bound[None])[0] for bound in tables.observation_bounds)
    fast = np.array([column.unit == "m/s" for column in tables.observation_columns])
    np.testing.assert_allclose(low[~fast], -1.0, atol=1e-6)
    np.testing.assert_allclose(high[~fast], 1.0, atol=1e-6)
    assert (high[fast] > 1.0).all() and not scaling.normalize(np.zeros((1, len(fast)), np.float32))[0, fast].any()


@given(st.lists(st.floats(-3.0, 3.0, width=32), min_size=4, max_size=4))
@settings(deadline=None, derandomize=True)
def test_actions_are_linear_between_the_bounds(outputs: list[float]) -> None:
    low, high = np.array([0.05, 0.05, 0.3, 0.3]), np.array([0.95, 0.9, 10.0, 10.0])
    none = np.zeros(0, np.float32)
    scaling = Scaling(none, none, none, low.astype(np.float32), high.astype(np.float32))
    action = scaling.to_actions(np.array([outputs], np.float32))
    assert action.dtype == np.float32
    share = (action[0] - low) / (high - low)
    np.testing.assert_allclose(2.0 * share - 1.0, np.clip(outputs, -1.0, 1.0), atol=1e-5)


def test_the_bounds_themselves_are_inside_the_action_space() -> None:
    tables = Tables("match-v0", 2)
    scaling = Scaling.from_tables(tables)
    for output in (-1.0, 1.0, -7.0, 7.0, np.inf):
        tables.step(scaling.to_actions(np.full((4, 4), output, np.float32)).reshape(2, 2, 4))  # refuses what is outside


@pytest.mark.parametrize("given", VARIANTS)
@pytest.mark.parametrize("made_for", VARIANTS)
def test_columns_are_read_by_name(made_for: str, given: str) -> None:
    source, target = Tables(made_for, 1), played(given)
    scaling = Scaling.from_tables(source)
    wanted, shown = names(source), names(target)
    seen = InputMapping.by_name(scaling, wanted, shown).inputs(target.observations[:, 1])
    assert seen.shape == (len(target), len(wanted)) and seen.dtype == np.float32
    for at, name in enumerate(wanted):
        if name in shown:
            numbers = target.observations[:, 1, shown.index(name)].astype(np.float64)
            expected = (numbers - float(scaling.centre[at])) / float(scaling.span[at])
        else:
            expected = np.zeros(len(target))
        np.testing.assert_allclose(seen[:, at], expected, atol=1e-5, err_msg=name)
    assert made_for == given or set(wanted) != set(shown)


def test_mapping_does_not_change_the_observations() -> None:
    tables = Tables("defence-v0", 3)
    before = tables.observations.copy()
    input_mapping = InputMapping.by_name(Scaling.from_tables(tables), names(tables), ["other", *names(tables)[1:]])
    input_mapping.inputs(tables.observations[:, 0])[:] = 9.0
    assert (tables.observations == before).all()
