"""The controls of a regime's proof in the report."""

from __future__ import annotations

from sim2real.diagnose.engine.twins import NULL, PERMUTED
from sim2real.diagnose.finding import Account, Twin
from sim2real.diagnose.report import words
from sim2real.diagnose.report.words import number

NAMES = {NULL: "null twin", PERMUTED: "permutation twin"}
HEAD = ("data", "without the laws", "with them", "the search names something")
READ = (
    "A null twin is the simulator with its refitted numbers and fresh noise. A permutation twin is the recording's own "
    "misses, each launch's with a sign drawn by lot. Neither holds a law, so the test is that with the laws no less is "
    "left of either than without them. A search, among laws with a name and those that were found, should name nothing "
    "in null twins: once in six is an accident that "
    "happens, more often speaks against what it names in the recording. In a permutation twin it is not asked, since "
    "what the recording lacks is still in there, turned round."
)


def twins_table(one: Account) -> str:
    """A regime's launches, each predicted by others, beside their twins; "" where there are no twins."""
    twins = next((each.twins for each in one.findings if each.twins), {})
    if not twins or one.selection is None or not one.selection.floor_m:
        return ""
    before, after = (number(size / one.selection.floor_m) for size in (one.selection.before_m, one.selection.after_m))
    rows = [["the recording", before, after, "yes"]]
    rows += [[NAMES[name], number(twin.before), number(twin.after), _named(twin)] for name, twin in twins.items()]
    note = "The same laws in twins: what is left of launches that they were not fitted to, in units of the noise"
    return words.table(note, HEAD, rows, (1, 2, 3)) + words.folded("How to read this", words.paragraph(READ))


def _named(twin: Twin) -> str:
    return "–" if twin.named is None else f"in {twin.named} of {twin.of}"
