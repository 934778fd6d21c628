"""What becomes of plans: followed, late, lost."""

from __future__ import annotations

from sim2real.table.plan_fates import PlanFates


def test_a_plan_that_is_followed_is_not_missed() -> None:
    fates = PlanFates()
    fates.send(7, 1.0)
    for time, number in ((0.999, 6), (1.001, 6), (1.003, 7), (1.2, 7), (9.0, 0)):
        fates.see(number, time)
    assert fates.take_missed() == 0


def test_a_plan_that_nothing_is_heard_of_by_six_milliseconds_after_its_begin_was_lost() -> None:
    fates = PlanFates()
    fates.send(7, 1.0)
    fates.see(6, 1.005)
    assert fates.take_missed() == 0
    for time in (1.007, 1.009):
        fates.see(6, time)
    assert (fates.take_missed(), fates.take_missed()) == (1, 0)


def test_a_plan_that_is_refused_is_missed_once() -> None:
    fates = PlanFates()
    fates.send(7, 1.0)
    fates.refuse_late()
    fates.see(6, 1.1)
    fates.refuse_late()  # of nothing that is known
    assert fates.take_missed() == 1


def test_the_fourth_in_a_row_is_hopeless_unless_one_was_followed_between() -> None:
    fates = PlanFates()
    for number in range(1, 4):
        fates.send(number, 1.0 * number)
        fates.see(0, number + 0.5)
    assert not fates.hopeless
    fates.send(4, 4.0)
    fates.see(4, 4.001)
    fates.send(5, 5.0)
    fates.refuse_late()
    assert not fates.hopeless
    for number in range(6, 9):
        fates.send(number, 1.0 * number)
        fates.refuse_late()
    assert fates.hopeless


def test_lost_plans_that_follow_each_other_quickly_are_hopeless_too() -> None:
    """Every 16 ms, while the fate of one is known 20 ms after it was sent. The plan before the newest cannot be gone
    back to: the newest was made to follow it."""
    fates, time = PlanFates(), 0.0
    for number in range(1, 6):
        fates.send(number, time + 0.014)
        for _ in range(8):
            fates.see(0, time)
            time += 0.002
    assert fates.hopeless and fates.take_missed() == 0
    for _ in range(8):
        fates.see(0, time)
        time += 0.002
    assert fates.take_missed() == 1
