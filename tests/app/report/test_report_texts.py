"""Names, units and descriptions from anybody in reports: drawn letter by letter, and harmless."""

import json

import pytest

from core.errors import printable

FORMULA = r"$\frac{$"  # begins a formula that never ends
ORDERS = "\x1b]0;title\x07\x1b[31mred\x9b2J\u202eback\u2028\x7f"


@pytest.fixture
def unruly(small):
    """The small network under names that are no formulas and give a terminal orders."""
    nodes = {f"{name}{FORMULA}": node for name, node in small["nodes"].items()}
    links = [
        [f"{node}{FORMULA}.{port}" for node, port in (end.split(".") for end in link)]
        for link in small["links"]
    ]
    nodes["slices"] = {"module": "mtf_slices"}
    links.append([f"blur{FORMULA}.mtf", "slices.transfer"])
    told = {"name": f"{FORMULA} {ORDERS}", "description": f"a{ORDERS}z\tand\nmore"}
    return {**small, **told, "nodes": nodes, "links": links}


def test_a_report_of_unruly_names(works, write, unruly, tmp_path):
    done = works("run", write(unruly), "--report", "r.html", "--report", "r.json")
    page, facts = (tmp_path / "r.html").read_text(), (tmp_path / "r.json").read_text()
    for text in (page, facts, done.stdout):
        assert not [letter for letter in text if letter in ORDERS and not letter.isprintable()]
    assert json.loads(facts)["network"]["description"] == unruly["description"]
    assert r"\u001b]0;title\u0007" in page


def test_what_a_terminal_would_obey_becomes_an_escape():
    assert printable("a\tb\nc\r\n") == "a\tb\nc\r\n"
    assert printable("é 視 🔭 µm²") == "é 視 🔭 µm²"
    assert printable("\x1b[31m") == r"\u001b[31m"
    assert printable(ORDERS).isprintable()
    assert json.loads(printable(json.dumps(ORDERS, ensure_ascii=False))) == ORDERS
    assert printable("\udc80") == r"\udc80"
