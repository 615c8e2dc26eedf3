"""The benchmark runs, says what it promises and writes what it is asked for; no timings."""

import json
import os

import pytest

from app.bench import PARTS
from app.bench.timing import STEADY
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
