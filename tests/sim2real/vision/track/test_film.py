"""The film's radius and spread, from rims that are made by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.vision.track.disc import find_disc
from sim2real.vision.track.film import Film, FilmGauge, measure
from sim2real.vision.track.subpixel_edges import EdgePoints

RADIUS, SPREAD = 0.0305, 1.1


def rim(
    place: tuple[float, float], pixel: tuple[float, float], shown: float = 360.0, noise: float = 0.05, seed: int = 0
) -> EdgePoints:
    """The edge of a film that is seen SPREAD pixels wider, where a pixel is so wide along x and y [m]; shown: [deg].

    A pixel outwards of an ellipse of half axes a pixel long each is where the tangent is moved outwards by that much.
    """
    rng = np.random.default_rng(seed)
    angle = np.radians(np.linspace(0.0, shown, 100, endpoint=False))
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    in_picture = normal * np.array(pixel)
    in_picture /= np.linalg.norm(in_picture, axis=1, keepdims=True)
    steps = in_picture * np.array(pixel)
    off = SPREAD + rng.normal(0.0, noise, len(angle))
    return EdgePoints(np.array(place) + RADIUS * normal + off[:, None] * steps, steps)


def test_one_disc_in_a_slanting_view_tells_both() -> None:
    films = [measure(rim((1.8, 0.3), (2.8e-3, 1.6e-3), seed=seed)) for seed in range(20)]
    assert all(films)
    off = np.array([(one.radius - RADIUS, one.spread - SPREAD) for one in films if one])
    assert np.abs(off[:, 0]).mean() < 0.3e-3 and np.abs(off[:, 1]).mean() < 0.15
    square = [row @ np.linalg.solve(one.covariance, row) for row, one in zip(off, films, strict=True) if one]
    assert np.mean(square) < 4.0


def test_a_part_of_a_disc_is_not_measured() -> None:
    assert measure(rim((1.8, 0.3), (2.8e-3, 1.6e-3), shown=250.0)) is None
    gauge = FilmGauge(0.0309)
    gauge.add(rim((1.8, 0.3), (2.8e-3, 1.6e-3), shown=250.0))
    assert gauge.discs == 0 and gauge.film.radius == 0.0309 and gauge.film.covariance[0, 0] > 1e-3**2


def test_more_places_tell_more_and_one_place_only_once() -> None:
    gauge, sure = FilmGauge(0.0309), []
    for k, x in enumerate((1.8, 1.8, 1.2, 0.6)):
        gauge.add(rim((x, 0.3), (1.5e-3 * x, 0.9e-3 * x), seed=k))
        sure.append(np.sqrt(gauge.film.covariance[0, 0]))
    assert gauge.discs == 3 and sure[0] == sure[1] > sure[2] > sure[3]
    assert gauge.film.radius == pytest.approx(RADIUS, abs=0.2e-3)
    assert gauge.film.spread == pytest.approx(SPREAD, abs=0.15)


def test_half_a_disc_is_where_it_is_only_with_the_measured_film() -> None:
    """With a film that is taken to be as wide as it is seen elsewhere, its centre is a millimetre off."""
    gauge, place, pixel = FilmGauge(0.0309), (0.9, 0.3), (1.6e-3, 1.2e-3)
    for k, x in enumerate((1.9, 1.3)):
        gauge.add(rim((x, 0.3), (1.5e-3 * x, 0.9e-3 * x), seed=k))
    half = rim(place, pixel, shown=150.0)
    disc, wrong = find_disc(half, gauge.film), find_disc(half, Film.known(RADIUS))
    assert disc is not None and wrong is not None
    assert np.linalg.norm(disc.centre - place) < max(2.5 * disc.deviation, 0.3e-3) < 1e-3
    assert np.linalg.norm(wrong.centre - place) > 1e-3


def test_another_disc_is_not_taken_for_the_film() -> None:
    gauge = FilmGauge(0.0309)
    gauge.add(rim((1.8, 0.3), (2.8e-3, 1.6e-3)))
    before = gauge.film
    other = rim((0.9, 0.3), (1.6e-3, 1.2e-3))
    gauge.add(EdgePoints((other.places - (0.9, 0.3)) * 1.4 + (0.9, 0.3), other.steps))
    assert gauge.film == before
