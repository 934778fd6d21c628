"""Segments of paths with known events: no false and no missed events."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.recording.folder import Recording, Stream, read_recording
from sim2real.segmentation.segments import segment
from tests.places import SHARED
from tests.sim2real.diagnose.synthetic import MALLET, META, RADIUS, RATE, WIDTH, bouncing, recorded


def shared(name: str) -> Recording:
    if not SHARED.is_dir():
        pytest.skip(f"the shared recordings are not beside this checkout ({SHARED})")
    return read_recording(SHARED / name)


def random_launches(rng, count, slow, fast):
    angle, speed = rng.uniform(0, 2 * np.pi, count), rng.uniform(slow, fast, count)
    x, y = rng.uniform(0.2, 1.8, count), rng.uniform(0.2, 0.8, count)
    return np.stack([x, y, speed * np.cos(angle), speed * np.sin(angle)], axis=1)


def far_from_ends(contacts, seconds, margin=0.06):
    return [contact for contact in contacts if margin < contact[0] % seconds < seconds - margin]


@pytest.mark.slow
@pytest.mark.parametrize("noise", [0.0002, 0.0006, 0.001])
def test_wall_hits_are_found_in_place_and_time_by_a_bad_camera(noise):
    rng = np.random.default_rng(1)
    path, contacts = bouncing(random_launches(rng, 60, 0.5, 4.0), 2.0)
    recording, truth = recorded(path, contacts, rng, noise, drops=0.02, held=0.02, wild=0.003)
    segments = segment(recording)
    walls = segments.of_kind("wall")
    true_contacts = [contact for contact in far_from_ends(truth.contacts, 2.0) if contact[2] > 0.3]
    missed = [
        contact
        for contact in true_contacts
        if not any(h.where == contact[1] and abs(h.t - contact[0]) < 1 / RATE for h in walls)
    ]
    assert len(true_contacts) > 150
    assert len(missed) <= 0.01 * len(true_contacts), missed
    everything = np.array([contact[0] for contact in truth.contacts] + [2.0 * launch for launch in range(60)])
    invented = [h for h in segments.contacts if np.min(np.abs(everything - h.t)) > 3 / RATE]
    assert invented == []


def test_launches_wild_and_held_frames_are_told_apart():
    rng = np.random.default_rng(2)
    path, contacts = bouncing(random_launches(rng, 40, 0.5, 3.0), 2.0)
    recording, truth = recorded(path, contacts, rng, 0.0006, drops=0.02, held=0.02, wild=0.005)
    segments = segment(recording)
    assert len(segments.launches) == 40
    assert (segments.held & truth.held).sum() == truth.held.sum()
    assert (segments.wild & truth.wild).sum() >= 0.97 * (truth.wild & ~truth.held).sum()
    assert (segments.wild & ~truth.wild & ~truth.held).sum() <= 0.001 * len(path)
    assert segments.noise_std == pytest.approx(0.0006, rel=0.1)


@pytest.mark.parametrize("pause", [600.0, 7200.0])
def test_a_long_pause_changes_no_piece(pause):
    rng = np.random.default_rng(2)
    path, contacts = bouncing(random_launches(rng, 20, 0.5, 3.0), 2.0)
    recording, _ = recorded(path, contacts, rng, 0.0006)
    assert recording.frames is not None
    middle = len(path) // 2 + 70  # within a glide or two
    t = recording.frames["t"] + np.where(np.arange(len(path)) >= middle, pause, 0.0)
    later = replace(recording, frames=Stream({**recording.frames.columns, "t": t}))
    one, other = segment(recording), segment(later)
    far = [contact.t - pause if contact.t > pause else contact.t for contact in other.contacts]
    assert len(other.launches) in (len(one.launches), len(one.launches) + 1)
    assert (
        len(far) > 20
        and sum(min(abs(t - contact.t) for contact in one.contacts) < 1e-6 for t in far) >= len(one.contacts) - 2
    )


@pytest.mark.parametrize("noise", [0.0002, 0.0005, 0.001])
def test_a_minute_of_smooth_gliding_has_no_hits(noise):
    rng = np.random.default_rng(3)
    t = np.arange(3 * RATE) / RATE
    launches = []
    for _ in range(20):
        v0, turn, start = rng.uniform(0.05, 1.2), rng.uniform(-0.3, 0.3), rng.uniform(0.1, 0.4)
        along = v0 / 0.4 * (1 - np.exp(-0.4 * t)) * min(1.0, 1.5 / (3 * v0))
        launches.append(np.stack([start + along, 0.5 + turn * along**2], axis=1))
    recording, _ = recorded(np.concatenate(launches), [], rng, noise, drops=0.01, wild=0.003)
    segments = segment(recording)
    assert segments.contacts == ()
    assert len(segments.glides) == 20
    assert sum(len(glide.t) for glide in segments.glides) > 0.98 * 60 * RATE


def test_slow_contacts_are_hits_or_unexplained_but_not_inside_a_glide():
    rng = np.random.default_rng(4)
    speed = rng.uniform(0.05, 0.3, 80)
    along = rng.uniform(-0.3, 0.3, 80)
    launches = np.stack([np.full(80, 1.0), RADIUS + 0.5 * speed, along, -speed], axis=1)
    path, contacts = bouncing(launches, 1.0, restitution=0.7)
    recording, truth = recorded(path, contacts, rng, 0.0005, drops=0.01)
    segments = segment(recording)
    true_contacts = far_from_ends(truth.contacts, 1.0)
    swallowed = [
        contact
        for contact in true_contacts
        if any(g.t[0] + 0.03 < contact[0] < g.t[-1] - 0.03 for g in segments.glides)
    ]
    assert len(true_contacts) == 80
    assert len(swallowed) <= 3, swallowed


def test_a_mallet_hit_is_the_mallets_and_in_its_frame():
    t = np.arange(0, 1.0, 1 / RATE)
    moment = 0.5 + 0.3 / RATE
    mallet = np.stack([0.4 + 0.8 * (t - moment), np.full(len(t), 0.5)], axis=1)
    x = 0.4 + RADIUS + MALLET + np.where(t < moment, -1.0, 2.2) * (t - moment)
    rng = np.random.default_rng(5)
    unseen = np.full(len(t), np.nan)
    columns = {"t": t, "puck_x": x + rng.normal(0, 3e-4, len(t)), "puck_y": 0.5 + rng.normal(0, 3e-4, len(t))}
    frames = Stream({**columns, "opponent_x": unseen, "opponent_y": unseen})
    log = Stream({"t": t, "mallet_x": mallet[:, 0], "mallet_y": mallet[:, 1]})
    (contact,) = segment(Recording("mallet", META, frames, log)).contacts
    assert (contact.kind, contact.where, contact.clean) == ("mallet", "robot", True)
    assert contact.t == pytest.approx(moment, abs=0.5 / RATE)
    np.testing.assert_allclose(contact.v_in, [-1.0, 0.0], atol=4 * contact.v_std)
    np.testing.assert_allclose(contact.v_out, [2.2, 0.0], atol=4 * contact.v_std)
    np.testing.assert_allclose(contact.mallet_v, [0.8, 0.0], atol=1e-6)
    np.testing.assert_allclose(contact.normal, [1.0, 0.0], atol=0.01)
    (stranger,) = segment(Recording("nobody", META, frames)).contacts
    assert (stranger.kind, stranger.where) == ("unexplained", "nothing near")


def test_the_contact_line_is_measured_not_assumed():
    rng = np.random.default_rng(6)
    path, contacts = bouncing(random_launches(rng, 40, 1.0, 3.0), 2.0)
    path = path * [1.0, (WIDTH - 0.02) / WIDTH]
    segments = segment(recorded(path, contacts, rng, 0.0003)[0])
    assert segments.lines["y1"] == pytest.approx((WIDTH - RADIUS) * (WIDTH - 0.02) / WIDTH, abs=0.001)
    assert sum(h.where == "y1" for h in segments.of_kind("wall")) > 20


def test_timing_noise_is_told_from_position_noise():
    rng = np.random.default_rng(7)
    path, contacts = bouncing(random_launches(rng, 60, 0.02, 4.0), 2.0)
    recording, _ = recorded(path, contacts, rng, 0.0001, jitter=0.0004 * np.sqrt(12))
    assert recording.frames is not None
    noise = segment(recording).noise
    assert noise.clock == pytest.approx(0.0004, rel=0.25)
    assert noise.position == pytest.approx(0.0001, rel=0.35)


def test_no_puck_gives_no_pieces():
    nothing = segment(Recording("gantry", META))
    assert nothing.glides == () and nothing.contacts == () and nothing.launches == ()
    assert nothing.held.shape == (0,)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["null", "tilt", "wall_spin", "restitution_speed", "unlisted_vortex"])
def test_practice_recordings_leave_nothing_unexplained(name):
    segments = segment(shared(f"practice/{name}"))
    assert len(segments.launches) in (40, 60)
    assert len(segments.of_kind("unexplained")) <= 2
    assert len(segments.of_kind("wall")) > 50
    assert segments.noise_std == pytest.approx(0.0006, rel=0.05)


def test_real_play_is_cut():
    segments = segment(shared("ubc/play_a"))
    assert len(segments.of_kind("wall")) > 180 and len(segments.of_kind("mallet")) > 50
    assert segments.lines["y0"] == pytest.approx(0.040, abs=0.001)
    assert 0.00003 < segments.noise_std < 0.0002
