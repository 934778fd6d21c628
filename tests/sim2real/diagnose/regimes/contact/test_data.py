"""Contacts in the frame of their normal: components, angles, selection and concatenation."""

from dataclasses import fields

import numpy as np
import pytest

from sim2real.diagnose.regimes.contact.data import (
    Contacts,
    common_place_variance,
    join_contacts,
    make_contacts,
    select_contacts,
    velocity_errors,
)
from sim2real.diagnose.regimes.contact.motion import ContactSide
from sim2real.diagnose.regimes.mallet.data import MalletContacts


def row(normal, before, t: float = 0.0) -> dict:
    """The fields of a contact without common errors."""
    pair, zero = np.zeros((2, 2, 2)), np.zeros(2)
    return {
        "normal": np.array(normal), "t": t, "place": zero, "velocity_before": np.array(before), "velocity_after": zero,
        "velocity_covariance": pair, "common_errors": np.zeros((2, 2, 0)), "normal_std": 0.0, "spin_chain": 3,
        "spin_unknown": True, "cluster": 7,
    }  # fmt: skip


ROWS = [row([0.0, 1.0], [3.0, -4.0]), row([-1.0, 0.0], [2.0, 2.0], 1.0), row([0.6, 0.8], [-0.6, -0.8], 2.0)]


def test_velocities_along_and_across_the_normal() -> None:
    found = make_contacts(Contacts, ROWS, [], {})
    assert found.closing_speed == pytest.approx([4.0, 2.0, 1.0])
    assert found.tangential_velocity == pytest.approx([-3.0, -2.0, 0.0])
    assert np.degrees(found.incidence_angle) == pytest.approx([36.8699, 45.0, 0.0], abs=1e-4)
    assert found.axes[2] == pytest.approx(np.array([[0.6, 0.8], [-0.8, 0.6]]))


def test_the_approach_to_a_mallet_is_relative_to_it() -> None:
    mallet = {
        "mallet_velocity": np.array([1.0, 1.0]), "mallet_step": 0.0, "mallet_covariance": np.zeros((3, 3)),
        "turning": 0.0, "mallet_acceleration": np.zeros(2), "recording": 0,
    }  # fmt: skip
    found = make_contacts(
        MalletContacts,
        [{**ROWS[0], **mallet}],
        [],
        {"mallet_velocity": (2,), "mallet_covariance": (3, 3), "mallet_acceleration": (2,)},
    )
    assert found.closing_speed == pytest.approx([5.0]) and found.tangential_velocity == pytest.approx([-2.0])


def test_contacts_are_selected_and_joined_again() -> None:
    found = make_contacts(Contacts, ROWS, [], {})
    odd = np.array([True, False, True])
    both = join_contacts([select_contacts(found, odd), select_contacts(found, ~odd)])
    assert both.t == pytest.approx([0.0, 2.0, 1.0]) and both.normal[2] == pytest.approx([-1.0, 0.0])
    assert both.spin_unknown.dtype == bool and both.spin_chain.dtype == int


def test_no_contacts_have_the_shapes_of_some() -> None:
    none, some = make_contacts(Contacts, [], [], {}), make_contacts(Contacts, ROWS, [], {})
    for one in fields(Contacts):
        assert getattr(none, one.name).shape == (0, *getattr(some, one.name).shape[1:])


def test_errors_are_rotated_into_the_normal_s_axes() -> None:
    before = ContactSide(
        np.zeros(2), np.zeros(2), np.diag([9.0, 9.0, 1.0, 4.0]), np.array([[0.0], [0.0], [1.0], [2.0]])
    )
    found = velocity_errors(np.array([0.0, 1.0]), before, before)  # along y, and then along -x
    assert found["velocity_covariance"][0] == pytest.approx(np.diag([4.0, 1.0]))
    assert found["common_errors"][1] == pytest.approx(np.array([[2.0], [-1.0]]))


def test_a_common_error_moves_a_place_by_the_mean_of_both_sides() -> None:
    """Of two common errors, one moves the places of both sides by 3 and 4 mm; the other moves them in opposite ways."""
    nothing, covariance = np.zeros(2), np.zeros((4, 4))
    first, second = np.zeros((4, 2)), np.zeros((4, 2))
    first[:, 0] = second[:, 0] = (0.003, 0.004, 1.0, 1.0)
    first[0, 1], second[0, 1] = 0.01, -0.01
    sides = [ContactSide(nothing, nothing, covariance, errors) for errors in (first, second)]
    assert common_place_variance(*sides) == pytest.approx((0.003**2 + 0.004**2) / 2.0)
