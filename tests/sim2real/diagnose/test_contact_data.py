"""Contacts in the frame of their normal: components, angles, and parts put together and taken out."""

from dataclasses import fields

import numpy as np
import pytest

from sim2real.diagnose.contact_data import Contacts, contacts_of, in_axes, join, kept, shared_variance
from sim2real.diagnose.impacts import Side
from sim2real.diagnose.mallet.data import Blows


def row(normal, before, t: float = 0.0) -> dict:
    """One contact as plain values, of a law with one number."""
    pair, zero = np.zeros((2, 2, 2)), np.zeros(2)
    return {
        "normal": np.array(normal), "t": t, "place": zero, "before": np.array(before), "after": zero, "spread": pair,
        "drift": np.zeros((2, 2, 0)), "turn": 0.0, "chain": 3, "lost": True, "cluster": 7,
    }  # fmt: skip


ROWS = [row([0.0, 1.0], [3.0, -4.0]), row([-1.0, 0.0], [2.0, 2.0], 1.0), row([0.6, 0.8], [-0.6, -0.8], 2.0)]


def test_velocities_along_and_across_the_normal() -> None:
    found = contacts_of(Contacts, ROWS, [], {})
    assert found.closing == pytest.approx([4.0, 2.0, 1.0])
    assert found.sliding == pytest.approx([-3.0, -2.0, 0.0])
    assert np.degrees(found.angle) == pytest.approx([36.8699, 45.0, 0.0], abs=1e-4)
    assert found.axes[2] == pytest.approx(np.array([[0.6, 0.8], [-0.8, 0.6]]))


def test_a_blow_is_told_past_the_mallet() -> None:
    mallet = {"driven": np.array([1.0, 1.0]), "step": 0.0, "swing": np.zeros((3, 3))}
    found = contacts_of(Blows, [{**ROWS[0], **mallet}], [], {"driven": (2,), "swing": (3, 3)})
    assert found.closing == pytest.approx([5.0]) and found.sliding == pytest.approx([-2.0])


def test_parts_are_joined_and_taken_out_again() -> None:
    found = contacts_of(Contacts, ROWS, [], {})
    odd = np.array([True, False, True])
    both = join([kept(found, odd), kept(found, ~odd)])
    assert both.t == pytest.approx([0.0, 2.0, 1.0]) and both.normal[2] == pytest.approx([-1.0, 0.0])
    assert both.lost.dtype == bool and both.chain.dtype == int


def test_none_have_the_shapes_of_some() -> None:
    none, some = contacts_of(Contacts, [], [], {}), contacts_of(Contacts, ROWS, [], {})
    for one in fields(Contacts):
        assert getattr(none, one.name).shape == (0, *getattr(some, one.name).shape[1:])


def test_covariances_are_turned_into_the_normal_s_axes() -> None:
    before = Side(np.zeros(2), np.zeros(2), np.diag([9.0, 9.0, 1.0, 4.0]), np.array([[0.0], [0.0], [1.0], [2.0]]))
    found = in_axes(np.array([0.0, 1.0]), before, before)  # along y, and then along -x
    assert found["spread"][0] == pytest.approx(np.diag([4.0, 1.0]))
    assert found["drift"][1] == pytest.approx(np.array([[2.0], [-1.0]]))


def test_what_all_contacts_have_in_common_moves_their_places_by_its_mean() -> None:
    """Two numbers of the law: one moves both motions' places by 3 and 4 mm, the other moves them apart."""
    nothing, covariance = np.zeros(2), np.zeros((4, 4))
    first, second = np.zeros((4, 2)), np.zeros((4, 2))
    first[:, 0] = second[:, 0] = (0.003, 0.004, 1.0, 1.0)
    first[0, 1], second[0, 1] = 0.01, -0.01
    sides = [Side(nothing, nothing, covariance, drift) for drift in (first, second)]
    assert shared_variance(*sides) == pytest.approx((0.003**2 + 0.004**2) / 2.0)
