"""Defaults are part of every network file: what a file leaves out has them, also years later.

Who changes one changes what saved networks give. `module_defaults.json` holds them, a line for each
module; new modules and new parameters need not be there. `python` with this file writes it anew.
"""

import json
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path += [str(ROOT), str(ROOT / "tests" / "support")]

from module_defaults import DEFAULTS  # noqa: E402 - a script has to find it

FILE = Path(__file__).with_name("module_defaults.json")
RECORDED = json.loads(FILE.read_text(encoding="utf-8"))


@pytest.mark.parametrize("key", RECORDED)
def test_what_is_left_out_has_the_recorded_default(key):
    """What is not recorded was empty, taken from the input or the context, or is new since."""
    assert {name: DEFAULTS[key].get(name) for name in RECORDED[key]} == RECORDED[key]


if __name__ == "__main__":
    found = {key: {name: value for name, value in sorted(values.items()) if value is not None}
             for key, values in sorted(DEFAULTS.items())}  # fmt: skip
    lines = [f"{json.dumps(key)}: {json.dumps(values)}" for key, values in found.items()]
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
