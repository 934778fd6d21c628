"""The words of the report that a newcomer may not know."""

from __future__ import annotations

from sim2real.diagnose.report.words import text

WORDS = {
    "regime": "one kind of motion: glide, wall (bounces), mallet (blows), gantry (the drive), sensing (the camera).",
    "launch": "an unbroken run of the puck, from a push until it rests or is taken away; it is kept whole.",
    "held out": "kept from every fit, choice and correction: how far off they are is the proof of what was found.",
    "noise": "what the sensors err by, and what no two bounces or blows of a real table have in common.",
    "twin": "a copy of the recording in which, by construction, nothing is missing: a control of the proof.",
}


def glossary() -> str:
    """A line for each word."""
    lines = "".join(f"<dt>{text(word)}</dt><dd>{text(meaning)}</dd>" for word, meaning in WORDS.items())
    return f'<dl class="glossary">{lines}</dl>'
