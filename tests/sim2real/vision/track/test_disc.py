"""Discs from rim points that are drawn here, with whatever else a picture has."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.vision.track.disc import find_disc
from sim2real.vision.track.film import Film
from sim2real.vision.track.subpixel_edges import EdgePoints

RADIUS, PIXEL = 0.0309, 1.8e-3
FILM = Film.known(RADIUS)
CENTRE = np.array([0.7, 0.4])


def arc(
    begin: float, end: float, noise: float = 0.0, radius: float = RADIUS, seed: int = 0, count: int = 100
) -> EdgePoints:
    """Points of a circle from one angle to another [degrees], off by some noise [px] outwards."""
    angle = np.radians(np.linspace(begin, end, max(int(count * abs(end - begin) / 360), 2), endpoint=False))
    out = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    off = PIXEL * np.random.default_rng(seed).normal(0.0, noise, (len(angle), 1))
    return EdgePoints(CENTRE + (radius + off) * out, PIXEL * out)


def line(
    start: tuple[float, float], end: tuple[float, float], outwards: tuple[float, float], count: int = 30
) -> EdgePoints:
    places = np.linspace(start, end, count)
    return EdgePoints(places, PIXEL * np.tile(outwards, (count, 1)))


def off(rim: EdgePoints) -> float:
    disc = find_disc(rim, FILM)
    assert disc is not None
    return float(np.linalg.norm(disc.centre - CENTRE))


@pytest.mark.parametrize("span", [(0, 360), (20, 200), (-60, 60)])
def test_exact_points_give_the_exact_centre(span):
    assert off(arc(*span)) < 1e-8


def test_the_chord_of_what_hides_it_pulls_it_nowhere():
    half = arc(-80, 80)
    chord = line(half.places[0], half.places[-1], (-1.0, 0.0))  # the beam's edge: inside the disc, facing outwards
    assert off(EdgePoints.joined([half, chord])) < 1e-6


def test_glints_beside_it_and_a_wrong_fifth_of_the_points_pull_it_nowhere():
    rim = arc(0, 250, noise=0.05)
    glint = EdgePoints(arc(0, 360, radius=0.008, count=30).places + np.array([0.04, 0.02]), arc(0, 360, count=30).steps)
    assert off(EdgePoints.joined([rim, glint])) < 0.1e-3


def test_deviations_cover_the_errors_of_arcs_whose_points_err_together_in_fours():
    for span in ((0, 360), (0, 120)):
        far = []
        for seed in range(200):
            coarse = np.repeat(np.random.default_rng(seed).normal(0.0, 0.05, 25), 4)
            whole = arc(0, 360, count=100)
            angle = np.degrees(np.arctan2(*(whole.places - CENTRE).T[::-1])) % 360
            distorted = EdgePoints(whole.places + coarse[:, None] * whole.steps, whole.steps).where(angle < span[1])
            disc = find_disc(distorted, FILM)
            assert disc is not None
            error = disc.centre - CENTRE
            far.append(error @ np.linalg.solve(disc.covariance, error))
        assert np.mean(np.array(far) > 5.99) < 0.15 and 0.5 < np.median(far) / 1.386 < 1.5  # 5 % and 1 are just right


def test_deviations_cover_what_all_edges_are_off_by_alike_as_a_lamp_brightens_them():
    """An arc's centre follows such an error, which its points' scatter does not show."""
    disc = find_disc(arc(0, 100, radius=RADIUS + 0.05 * PIXEL), FILM)
    assert disc is not None
    error = disc.centre - CENTRE
    assert np.linalg.norm(error) > 0.1e-3 and error @ np.linalg.solve(disc.covariance, error) < 5.99


def test_a_disc_of_another_size_has_few_points_on_it_and_a_line_has_none():
    larger = find_disc(arc(0, 360, radius=0.043), FILM)
    assert larger is None or larger.seen < 0.2
    straight = find_disc(line((0.6, 0.4), (0.8, 0.4), (0.0, 1.0)), FILM)
    assert straight is None or straight.seen < 0.2


def test_a_hole_is_no_disc():
    inwards = arc(0, 360)
    assert find_disc(EdgePoints(inwards.places, -inwards.steps), FILM) is None


def test_how_much_is_seen():
    disc = find_disc(arc(0, 180), FILM)
    assert disc is not None
    assert disc.seen == pytest.approx(0.5, abs=0.03) and disc.outside == 0
