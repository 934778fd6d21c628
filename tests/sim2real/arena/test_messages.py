"""What pages say is checked, whatever it is."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim2real.arena.game import View
from sim2real.arena.messages import MOST_CHARACTERS, Again, Aim, Ping, parse, state


def test_the_three_kinds() -> None:
    assert parse('{"kind":"aim","x":0.5,"y":1,"sent":12.5}') == Aim(0.5, 1, 12.5)
    assert parse('{"kind":"ping","sent":3}') == Ping(3)
    assert parse('{"kind":"again"}') == Again()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("{", "that is not JSON"),
        ("[" * 200, "that is not JSON"),
        ("7", "without a kind of aim, ping, again"),
        ('{"kind":["aim"]}', "without a kind"),
        ('{"kind":"aim","x":0.5,"y":1}', "of kind aim; expected the numbers sent, x, y"),
        ('{"kind":"again","x":1}', "of kind again; expected the numbers none"),
        ('{"kind":"ping","sent":NaN}', "of kind ping"),
        ('{"kind":"ping","sent":true}', "of kind ping"),
        ('{"kind":"ping","sent":1e999}', "of kind ping"),
        ('{"kind":"aim","x":11,"y":0,"sent":0}', "an aim at 11, 0; expected 10 m at most"),
        (" " * (MOST_CHARACTERS + 1), f"of {MOST_CHARACTERS + 1} characters"),
    ],
)
def test_anything_else_is_refused_in_one_line(text: str, words: str) -> None:
    with pytest.raises(ValueError, match=words) as caught:
        parse(text)
    assert "\n" not in str(caught.value)


@given(
    st.text()
    | st.recursive(
        st.none() | st.booleans() | st.floats() | st.text(),
        lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
    ).map(json.dumps)
)
def test_whatever_comes_is_a_message_or_refused(text: str) -> None:
    try:
        assert isinstance(parse(text), Aim | Ping | Again)
    except ValueError as error:
        assert str(error)


def test_a_state_is_as_short_as_it_is_exact() -> None:
    text = state(View(1.23456, (0.123456, 0.5), ((0.3, 0.4), (1.7, 0.6)), (1, 2), 178.76, ""), {"aim": 5.0})
    assert json.loads(text) == {
        "kind": "state", "time": 1.2346, "puck": [0.1235, 0.5], "mallets": [[0.3, 0.4], [1.7, 0.6]], "score": [1, 2],
        "left": 178.8, "ending": "", "aim": 5.0,
    }  # fmt: skip
    assert len(text) < 200
