"""The benchmark runs, says what it promises and writes what it is asked for; no timings."""

from __future__ import annotations

import json
import os
import sys
import warnings

import numpy as np
import pytest

from app.bench.measuring.bench_settings import PARTS, TABLES, Settings
from app.bench.measuring.isolation import STEADY, environment
from app.bench.measuring.kodak import FINAL, Kodak
from app.bench.measuring.loaded_network import SCENE
from app.bench.pages import markdown
from app.bench.pages.markdown import END, START, inserted
from app.bench.peers.peer_imports import load
from app.bench.peers.peer_self import OURS
from app.bench.truth import truth_laws
from app.command.cli import main
from app.run.own_process import command
from child_process import finished
from core.errors import FileError, UsageError

FACTS = {"format", "version", "date", "machine", "settings", "seconds", "parts"}
UNDRAWN = {
    "measure",
    "fit",
    "fresh_process",
    "one_thread",
    "editor",
    "study_points",
    "study_scenes",
    "scale_blocks",
    "scale_plan",
    "cameras",
    "peer_cameras",
    "frames",
    "poisson_quantile",
}


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


@pytest.mark.parametrize("part", PARTS)
def test_part(part, bench, request, tmp_path):
    words = ["--json", "b.json", "--markdown", "b.md", "--pictures", "drawn/here"]
    # A page draws every picture again, and those of this part are many.
    paged = part != "precision" or request.config.option.thorough
    done = bench(part, *words, *(["--html", "b.html"] if paged else []))
    assert (done.returncode, done.stderr) == (0, "")
    facts = json.loads((tmp_path / "b.json").read_text())
    assert set(facts) == FACTS
    assert (facts["format"], facts["version"]) == ("imagechain-bench", 1)
    machine = facts["machine"]
    assert {"processor", "cores", "usable_cores", "memory_bytes", "versions"} <= set(machine)
    assert set(machine["versions"]) == {"imagechain", "python", "numpy", "scipy"}
    assert machine["fft"] in done.stdout
    assert facts["settings"]["parts"] == [part]
    assert tuple(table["name"] for table in facts["parts"][part]) == TABLES[part]
    page = (tmp_path / "b.html").read_text() if paged else ""
    short = (tmp_path / "b.md").read_text()
    for table in facts["parts"][part]:
        assert set(table) == {"name", "title", "columns", "rows", "text"}
        assert table["rows"]
        assert table["text"]
        for row in table["rows"]:
            assert set(row) & set(table["columns"])
        assert table["title"] in done.stdout
        assert not paged or table["title"] in page
        assert (table["title"] in short) is (part != "precision")
    assert f"`imagechain bench --markdown {markdown.PAGE} --quick --only {part} --size 32`" in short
    files = {str(p.relative_to(tmp_path)) for p in tmp_path.rglob("*") if p.is_file()}
    drawn = {f"drawn/here/bench_{name}.png" for name in set(TABLES[part]) - UNDRAWN}
    assert files == {"b.json", "b.md", *(["b.html"] if paged else []), *drawn}
    for name in drawn:
        assert (tmp_path / name).read_bytes().startswith(b"\x89PNG")
    if part == "peers":
        another_program_has_the_same_electrons(facts["parts"][part])


def another_program_has_the_same_electrons(tables):
    """Where pyBSM is installed; without it every row says so and has our own figures."""
    rows = next(table["rows"] for table in tables if table["name"] == "peer_cameras")
    assert len(rows) == 9
    for row in rows:
        assert row["ours"] > 0
        assert (row["pybsm"] is None) == bool(row["note"])
        if row["pybsm"] is not None:
            assert abs(row["percent"]) < 0.01


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--only", "sped"], "sped"),
        (["--size", "33"], "multiple of 4"),
        (["--size", "many"], "whole number"),
        (["--json", ""], "file name"),
        (["--json", "no/such/folder/b.json"], "no folder"),
        (["--markdown", "."], "it is a folder"),
        (["--json", "p/bench_peers.png", "--pictures", "p", "--only", "peers"], "two outputs"),
        (["kodak_kir310"], "kodak_kir310"),
    ],
)
def test_bad_words(words, told, fails, steady):
    assert told in fails("bench", "--quick", *words)


def test_same_file_twice(fails, steady):
    assert "two outputs" in fails("bench", "--json", "b", "--html", "b")


def test_a_text_without_the_marks_is_left_alone(imagechain, steady, tmp_path):
    """And known before anything is measured."""
    (tmp_path / "README.md").write_text("# Mine\n")
    done = imagechain("bench", "--quick", "--markdown", "README.md")
    assert (done.returncode, done.stdout) == (2, "")
    assert START in done.stderr
    assert (tmp_path / "README.md").read_text() == "# Mine\n"


def test_in_this_process(capsys, steady, monkeypatch, tmp_path):
    """With the environment it wants it does not start itself again."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("app.bench.precision.precision_parts.MEASURES", ())
    assert main(["bench", "--quick", "--only", "precision", "--size", "32"]) == 0
    out, err = capsys.readouterr()
    assert "T0 = " in out
    assert not err
    assert not list(tmp_path.iterdir())


def test_markdown_goes_between_the_marks(tmp_path):
    file = tmp_path / "README.md"
    text = f"{START}\nnew\n{END}"
    assert inserted(file, text) == text + "\n"
    file.write_text(f"# Größe\n\n{START}\nold\n{END}\n\nrest\n", encoding="utf-8")
    assert inserted(file, text) == f"# Größe\n\n{text}\n\nrest\n"
    file.write_text(inserted(file, text), encoding="utf-8")
    assert inserted(file, text) == file.read_text(encoding="utf-8")


@pytest.mark.parametrize("content", [b"", f"{START}\n".encode(), f"{END}\n{START}\n".encode()])
def test_markdown_without_both_marks_is_refused(content, tmp_path):
    (tmp_path / "a.md").write_bytes(content)
    with pytest.raises(UsageError, match="end of bench table"):
        inserted(tmp_path / "a.md", "")


def test_markdown_that_is_no_text_is_refused(tmp_path):
    (tmp_path / "a.md").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(FileError, match="not text"):
        inserted(tmp_path / "a.md", "")


def test_settings_tell_their_options():
    assert Settings(tuple(PARTS)).words() == []
    told = Settings(("speed", "peers"), 64, True).words()
    assert told == ["--quick", "--only speed", "--only peers", "--size 64"]


def test_mpmath_missing_is_said(monkeypatch):
    from app.bench.precision.precision_charge_transfer import charge_transfer
    from app.bench.precision.precision_wavelengths import wavelengths

    monkeypatch.setattr(truth_laws, "mpmath", lambda: None)
    for measure in (charge_transfer, wavelengths):
        (table,) = measure(Settings(("precision",), 32, True))
        assert not table.rows
        assert "mpmath" in table.text


def test_peers_that_are_missing_or_fail_are_rows(monkeypatch):
    from app.bench.peers import peers_compared

    def broken(task):
        raise ZeroDivisionError("theirs")

    monkeypatch.setattr(peers_compared, "OURS", OURS[:1])
    monkeypatch.setattr(
        peers_compared, "PEERS", (("no_such_program", "Absent", broken), ("rich", "Broken", broken))
    )
    (table,) = peers_compared.peers(Settings(("peers",), 64, True))
    notes = {row["program"]: row["note"] for row in table.rows}
    assert notes["Absent"] == "not installed"
    assert notes["Broken"] == "failed: ZeroDivisionError: theirs"
    assert markdown._section(table.shortened()).count("\n|") == 5  # head, rule, three programs


def test_a_program_that_asks_pkg_resources_is_answered(monkeypatch, tmp_path):
    """As prysm does, where setuptools has it no more; what it warns of is not ours to say."""
    lines = [
        "import warnings",
        "import pkg_resources",
        "from pkg_resources import get_distribution",
        "of_setuptools = hasattr(pkg_resources, '__path__')",
        "warnings.warn('mine')",
        "__version__ = get_distribution('numpy').version",
    ]
    (tmp_path / "asks_its_version.py").write_text("\n".join(lines))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, "pkg_resources", raising=False)
    monkeypatch.setattr("app.bench.peers.peer_imports.find_spec", {}.get)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = load("asks_its_version")
    assert found.__version__ == np.__version__
    assert not found.of_setuptools
    assert "pkg_resources" not in sys.modules


def test_edits_start_from_what_was_there():
    kodak = Kodak(32)
    warm = kodak.warm()
    kodak.edited("electronics", "bits", (4, 8), warm)
    kodak.store.forget_all_but(warm)
    assert kodak.store.keys() == warm
    before = kodak.store.used_bytes
    kodak.store.clear()
    kodak.warm()
    assert kodak.store.used_bytes == before
    np.testing.assert_array_equal(kodak.value(kodak.network, SCENE), kodak.scene)
    assert kodak.value(kodak.network, FINAL).shape == (round(32 * 486 / 1024), 16)


def test_modules_of_a_child_are_ours(tmp_path):
    """A `core` in the user's folder is not ours."""
    (tmp_path / "core").mkdir()
    (tmp_path / "core/__init__.py").write_text("raise SystemExit(3)")
    words = ["bench", "--quick", "--only", "peers", "--size", 64]
    done = finished(
        command("app.command.cli", *map(str, words)), folder=tmp_path, env=environment()
    )
    assert (done.returncode, done.stderr) == (0, "")
