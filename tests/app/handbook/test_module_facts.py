"""Formulas, numbers and ranges of the modules' pages, which a better sentence must not change.

`module_facts.json` holds them, a line for each module; after a change that is meant, write it anew
with `python tests/app/handbook/test_module_facts.py`.
"""

import json
import re
from collections import Counter
from pathlib import Path

import pytest

from app.library_index import declarations
from nodes.library import standard_library

FILE = Path(__file__).with_name("module_facts.json")
_NUMBER = re.compile(
    r"(?<![\w.])[-−]?\d+(?:[.,]\d+)*(?:e[+-]?\d+)?(?: ?(?:%|µm|mm|°|K|Hz|mrad)\b)?"
)


def facts_of(declared):
    """Formulas as they are written, units, ranges, how often each number stands in the texts."""
    texts = [declared.text, *(formula.where for formula in declared.formulas)]
    texts += [formula.when for formula in declared.formulas]
    texts += [parameter.param.text for parameter in declared.parameters]
    texts += [readout.meaning for readout in declared.readouts]
    units = {p.name: p.param.unit for p in declared.parameters if p.param.unit}
    ranges = {p.name: [p.allowed(), *(p.param.slider or ())] for p in declared.parameters}
    return {
        "formulas": [formula.tex for formula in declared.formulas],
        "units": units | {r.name: r.unit for r in declared.readouts if r.unit},
        "ranges": {name: said for name, said in ranges.items() if said != ["true or false"]},
        "numbers": dict(sorted(Counter(_NUMBER.findall(" ".join(texts))).items())),
    }


def present():
    return {key: facts_of(one) for key, one in sorted(declarations(standard_library()).items())}


@pytest.fixture(scope="module")
def kept():
    return json.loads(FILE.read_text(encoding="utf-8"))


def test_formulas_units_ranges_and_numbers_are_those_kept(kept):
    found = present()  # a new module needs no line yet
    assert kept.keys() <= found.keys()
    assert {key: (kept[key], found[key]) for key in kept if kept[key] != found[key]} == {}


if __name__ == "__main__":
    lines = [f"{json.dumps(key)}: {json.dumps(facts, ensure_ascii=False)}"
             for key, facts in present().items()]  # fmt: skip
    FILE.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")
