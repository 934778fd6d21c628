"""The published figures of this repository follow from its raw outputs."""

from __future__ import annotations

from results.check import wrong_marks, wrong_outputs
from results.console import wrong_printed
from results.page import PAGE, page
from results.raw import read_raws
from results.rows import read_rows
from results.unmarked import wrong_numbers
from tests.places import ROOT


def test_the_page_follows_from_the_outputs() -> None:
    assert (ROOT / PAGE).read_text(encoding="utf-8") == page(read_rows(ROOT), read_raws(ROOT))


def test_every_marked_figure_agrees() -> None:
    assert wrong_marks(ROOT, read_rows(ROOT), read_raws(ROOT)) == []


def test_every_printed_answer_was_printed() -> None:
    assert wrong_printed(ROOT, read_rows(ROOT), read_raws(ROOT)) == []


def test_every_number_with_a_unit_is_marked_or_stated() -> None:
    assert wrong_numbers(ROOT, read_rows(ROOT), read_raws(ROOT)) == []


def test_every_output_is_of_its_row_and_of_a_commit_of_this_history() -> None:
    assert read_raws(ROOT)
    assert wrong_outputs(ROOT, read_rows(ROOT), read_raws(ROOT)) == []
