"""What a diagnosis writes for the simulator can be given to it, and says what it leaves out."""

from __future__ import annotations

from pathlib import Path

from puckpilot_env.effects_file import effect_values
from sim2real.diagnose.diagnosis import Diagnosis
from sim2real.diagnose.files import effects_toml
from sim2real.diagnose.finding import Account, Estimate, Finding


def finding(mechanism: str, values: dict[str, float]) -> Finding:
    return Finding("gantry", mechanism, (), (), "", {}, 1e-9, 2.0, 1.0, values=values)


def test_effects_that_no_table_can_be_given_are_left_out_with_a_reason(tmp_path: Path) -> None:
    found = (finding("voltage_sag", {"voltage_sag": 0.02}), finding("backlash", {"backlash_gap": 0.001}))
    account = Account("gantry", found, {"a2": Estimate(0.006, 0.005, 0.007, "V s^2")}, False, None)
    text = effects_toml(Diagnosis((account,)))
    file = tmp_path / "effects.toml"
    file.write_text(text)
    assert effect_values(file) == {"a2": 0.006, "voltage_sag": 0.02}
    assert "# backlash is left out: " in text
