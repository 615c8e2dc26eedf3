"""The benchmark runs, says what it promises and writes what it is asked for; no timings."""

import json
import os

import pytest

from app.bench.tables import PARTS, Chart, Table, chart_png, figure_text, verdict
from app.bench.timing import STEADY, paired
from app.command.library_commands import BENCH_PARTS

FACTS = {"format", "version", "date", "machine", "settings", "seconds", "parts"}
TABLES = {
    "speed": ["networks", "one_thread", "fresh_process"],
    "precision": ["precision", "edges", "pupil_sampling", "wavelengths", "charge_transfer",
                  "poisson", "skipping"],
    "peers": ["peers"],
    "studies": ["study_points", "study_scenes"],
    "measure": ["measure", "fit"],
}  # fmt: skip
DRAWN = {"networks", "peers", *TABLES["precision"]}


@pytest.fixture
def steady(monkeypatch):
    """The environment it wants, in which it does not start itself again."""
    for name, value in STEADY.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(os, "execve", None)


@pytest.fixture
def bench(imagechain, imagechain_process, steady, monkeypatch):
    """The command in this process, but for one part: it starts itself again, as for a user."""

    def run(part, *words):
        if part != "peers":
            return imagechain("bench", "--quick", "--only", part, "--size", 32, *words)
        for name in STEADY:
            monkeypatch.delenv(name)
        return imagechain_process("bench", "--quick", "--only", part, "--size", 32, *words)

    return run


def test_the_parts_are_those_of_the_command_line():
    assert tuple(PARTS) == BENCH_PARTS == tuple(TABLES)


@pytest.mark.parametrize("part", PARTS)
def test_part(part, bench, tmp_path):
    done = bench(part, "--json", "b.json", "--html", "b.html")
    assert (done.returncode, done.stderr) == (0, "")
    facts = json.loads((tmp_path / "b.json").read_text())
    assert set(facts) == FACTS
    assert (facts["format"], facts["version"]) == ("imagechain-bench", 1)
    machine = facts["machine"]
    assert {"processor", "cores", "usable_cores", "memory_bytes", "versions"} <= set(machine)
    assert set(machine["versions"]) == {"imagechain", "python", "numpy", "scipy"}
    assert machine["fft"] in done.stdout
    assert facts["settings"]["parts"] == [part]
    assert [table["name"] for table in facts["parts"][part]] == TABLES[part]
    page = (tmp_path / "b.html").read_text()
    for table in facts["parts"][part]:
        assert set(table) == {"name", "title", "columns", "rows", "text"}
        assert table["rows"]
        assert table["text"]
        for row in table["rows"]:
            assert set(row) & set(table["columns"])
        assert table["title"] in done.stdout
        assert table["title"] in page
    assert page.count("data:image/png") == len(set(TABLES[part]) & DRAWN)
    assert {p.name for p in tmp_path.rglob("*") if p.is_file()} == {"b.json", "b.html"}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--only", "sped"], "sped"),
        (["--size", "33"], "multiple of 4"),
        (["--json", "no/such/folder/b.json"], "no folder"),
    ],
)
def test_bad_words(words, told, fails, steady):
    assert told in fails("bench", "--quick", *words)


# --- tables ---


@pytest.mark.parametrize(
    ("value", "reach", "aim", "told"),
    [
        (6.0, 5.0, 2.5, "missed: 1.20 × limit"),
        (4.0, 5.0, 2.5, "met; 1.60 × target"),
        (40.0, 50.0, None, "met"),
        (40.0, None, None, ""),
    ],
)
def test_verdict(value, reach, aim, told):
    assert verdict(value, reach, aim) == told


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (0.0, "0"), (3e-7, "3e-7"), (9.996e5, "1e6"), (-4321.0, "-4320")],
)  # fmt: skip
def test_figure_text(value, text):
    assert figure_text(value) == text


def test_pairs_are_ratios_of_neighbours():
    units = iter([9.0, 1.0, 2.0, 4.0, 7.0, 5.0, 6.0])
    subjects = iter([9.0, 3.0, 4.0, 40.0])
    found = paired(lambda: next(subjects), lambda: next(units), pairs=3, warm_up=1)
    assert found["t0"] == 3.0  # 3, 2 and 10
    assert (found["ms"], found["t0_ms"], found["alone_ms"]) == (4e3, 2e3, 6e3)


ROWS = (
    {"choice": "a|b", "t0": 1.5, "error": 1e-3, "kind": "one"},
    {"choice": "c", "t0": 3.0, "error": 0.0, "kind": "one"},
    {"choice": "d", "t0": None, "error": 1e-9, "kind": "two"},
)
HEADS = {"choice": "choice", "t0": "T0", "error": "error", "kind": "kind"}


def table(rows=ROWS, **chart):
    return Table("t", "Title", HEADS, rows, "Text.", Chart("error", "choice", **chart))


@pytest.mark.parametrize("chart", [{"group": "choice"}, {"lines": True}])
def test_picture_of_what_was_measured(chart):
    drawn = chart_png(table(**chart))
    assert drawn is not None
    assert drawn.startswith(b"\x89PNG")
    # Told the same way twice, and not the same without its title.
    assert chart_png(table(**chart)) == drawn
    assert chart_png(table(**chart), titled=False) != drawn


def test_no_picture_of_nothing():
    assert chart_png(table(ROWS[2:])) is None
    assert chart_png(Table("t", "Title", HEADS, ROWS)) is None
    assert chart_png(table(where=("kind", "three"))) is None
