"""Tuned numbers that the wall and mallet regimes share."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class ContactNumbers:
    """Tuned numbers of contacts: selection, difference steps, and candidate laws."""

    longest_gap: float = tuned(
        0.12,
        "s",
        "longer gaps let an unseen event lie between a glide's last frame and the contact; shorter ones lose contacts "
        "that a beam hides",
        "choice: a beam hides a contact for a tenth of a second",
    )
    glide_overlap: float = tuned(
        0.01,
        "s",
        "less loses contacts timed just before the last frame of their glide; more pairs a contact with a glide that "
        "goes on after it",
        "choice: the estimated time of a contact may err by about a frame of a slow camera",
    )
    neighbour_margin: float = tuned(
        0.005,
        "s",
        "less lets a second contact at the edge of the gap change the motion unnoticed; more drops contacts that "
        "follow each other quickly",
        "choice: the estimated time of a contact may err by about a frame of a fast camera",
    )
    outlier_deviations: float = tuned(
        6.0,
        "standard deviations",
        "less rejects contacts with the wall by noise; more takes a hidden contact with a mallet for one with the wall",
        "choice: noise alone reaches it once in half a billion times",
    )
    flight_time: float = tuned(
        0.1,
        "s",
        "the time after which an error of a velocity is stated as one of the place: proportional to every size of an "
        "effect in millimetres",
        "choice: a tenth of a second, as the report states it",
    )
    velocity_step: float = tuned(
        1e-5,
        "m/s",
        "less loses a derivative in rounding; more sees the curvature of the law",
        "choice: a difference step far below any velocity noise",
    )
    parameter_step: float = tuned(
        1e-5,
        "range of the parameter",
        "less loses a derivative in rounding; more sees the curvature of the law",
        "choice: a difference step far below what a fit can resolve",
    )
    least_variance: float = tuned(
        1e-12,
        "m^2/s^2",
        "less divides by the rounding of a covariance; more claims noise that is not there",
        "choice: 1 µm/s, better than any velocity is known",
    )
    coefficient_unit: float = tuned(
        0.1,
        "1",
        "the share of a speed that a coefficient of 1 stands for: less makes large laws unlikely, more lets small ones "
        "vary freely",
        "choice: restitutions are expected to vary by about a tenth",
    )
    least_speed: float = tuned(
        0.1,
        "m/s",
        "less draws shares of a slow speed, which are noise; more draws too few contacts",
        "choice: an error of 1 cm/s is then a tenth of the share",
    )
    friction_growth: float = tuned(
        1.2,
        "1",
        "nearer to 1 leaves the second column of a friction to rounding; further leaves the local slope",
        "choice: a step of a fifth, which shows how the effect changes with the coefficient",
    )


CONTACT = ContactNumbers()
