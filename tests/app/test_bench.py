"""The benchmark runs, says what it promises and compares with a truth that is one; no timings."""

from __future__ import annotations

import json
import math
import os
import subprocess

import numpy as np
import pytest

from app.bench import truth
from app.bench.isolation import STEADY, command, environment
from app.bench.kodak import FINAL, PIXELS, SCENE, Kodak
from app.bench.peer_self import OURS
from app.bench.precision_pupils import SHAPES
from app.bench.stage_by_stage import optics, whole_chain
from app.bench.tables import figure_text, verdict
from app.bench.timing import paired
from app.cli import main

TABLES = {
    "speed": ["networks", "growth", "fresh_process"],
    "precision": [
        "precision",
        "edges",
        "pupil_sampling",
        "low_rank",
        "wavelengths",
        "charge_transfer",
        "poisson",
    ],
    "peers": ["peers"],
}
FACTS = {"format", "version", "date", "machine", "settings", "seconds", "parts"}


@pytest.mark.parametrize("part", TABLES)
def test_part(part, imagechain, tmp_path):
    words = ["--quick", "--only", part, "--size", 32, "--json", "b.json", "--html", "b.html"]
    done = imagechain("bench", *words)
    assert (done.returncode, done.stderr) == (0, "")
    facts = json.loads((tmp_path / "b.json").read_text())
    assert set(facts) == FACTS
    assert (facts["format"], facts["version"]) == ("imagechain-bench", 1)
    assert {"processor", "cores", "usable_cores", "memory_bytes", "versions"} <= set(
        facts["machine"]
    )
    assert set(facts["machine"]["versions"]) == {"imagechain", "python", "numpy", "scipy"}
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
    assert sorted(p.name for p in tmp_path.iterdir()) == ["b.html", "b.json"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--only", "sped"], "sped"),
        (["--size", "33"], "multiple of 4"),
        (["--size", "many"], "whole number"),
        (["--json", ""], "file name"),
        (["--json", "no/such/folder/b.json"], "no folder"),
        (["kodak_kir310"], "kodak_kir310"),
    ],
)
def test_bad_words(words, told, fails):
    assert told in fails("bench", "--quick", *words)


def test_same_file_twice(fails):
    assert "two outputs" in fails("bench", "--json", "b", "--html", "b")


def test_in_this_process(capsys, monkeypatch, tmp_path):
    """With the environment it wants it does not start itself again."""
    for name, value in STEADY.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setattr(os, "execve", None)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("app.bench.precision.MEASURES", ())
    assert main(["bench", "--quick", "--only", "precision", "--size", "32"]) == 0
    out, err = capsys.readouterr()
    assert "T0 = " in out
    assert not err
    assert not list(tmp_path.iterdir())


def test_mpmath_missing_is_said(monkeypatch):
    from app.bench.precision_laws import charge_transfer
    from app.bench.precision_wavelengths import wavelengths
    from app.bench.settings import Settings

    monkeypatch.setattr(truth, "mpmath", lambda: None)
    for measure in (charge_transfer, wavelengths):
        (table,) = measure(Settings(("precision",), 32, True))
        assert not table.rows
        assert "mpmath" in table.text


def test_peers_that_are_missing_or_fail_are_rows(monkeypatch):
    from app.bench import peers
    from app.bench.settings import Settings

    def broken(task):
        raise ZeroDivisionError("theirs")

    monkeypatch.setattr(peers, "OURS", OURS[:1])
    monkeypatch.setattr(
        peers, "PEERS", (("no_such_program", "Absent", broken), ("rich", "Broken", broken))
    )
    (table,) = peers.peers(Settings(("peers",), 64, True))
    notes = {row["program"]: row["note"] for row in table.rows}
    assert notes["Absent"] == "not installed"
    assert notes["Broken"] == "failed: ZeroDivisionError: theirs"


@pytest.mark.parametrize(
    ("value", "reach", "aim", "told"),
    [
        (6.0, 5.0, 2.5, "missed: 1.20 × reach"),
        (4.0, 5.0, 2.5, "met; 1.60 × aim"),
        (2.5, 5.0, 2.5, "met, aim too"),
        (40.0, 50.0, None, "met"),
        (40.0, None, None, ""),
    ],
)
def test_verdict(value, reach, aim, told):
    assert verdict(value, reach, aim) == told


@pytest.mark.parametrize(
    ("value", "text"), [(None, "-"), (0.0, "0"), (1.234567, "1.23"), (3e-7, "3e-7"), (5, "5")]
)
def test_figure_text(value, text):
    assert figure_text(value) == text


def test_pairs_are_ratios_of_neighbours():
    units = iter([9.0, 1.0, 2.0, 4.0, 7.0, 5.0, 6.0])
    subjects = iter([9.0, 3.0, 4.0, 40.0])
    found = paired(lambda: next(subjects), lambda: next(units), pairs=3, warm_up=1)
    assert found.ratio == 3.0  # 3, 2 and 10
    assert (found.seconds, found.t0_seconds, found.alone_seconds) == (4.0, 2.0, 6.0)


def test_stage_by_stage_is_the_same_optics():
    """Two independent programs of one chain agree, periodic as in 1996."""
    kodak = Kodak(64, "double")
    network = kodak.without_photons().with_parameter("init", "edges", "periodic")
    expected = optics(kodak.scene)
    got = kodak.value(network, PIXELS)
    # 1 − 0.99999 keeps eleven digits, and 640 transfers of that error are left.
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
    picture = whole_chain(kodak.scene, lines=30, samples=32, seed=1)
    assert picture.shape == (30, 32)
    assert len(np.unique(optics(np.full((8, 8), 7.0)).round(12))) == 1


@pytest.mark.parametrize(
    ("edges", "direct"),
    [("reflect", truth.mirrored_picture), ("periodic", truth.periodic_picture)],
)
def test_direct_sums(edges, direct):
    kodak = Kodak(36, "double")
    network = kodak.without_photons().with_parameter("init", "edges", edges)
    interval = math.radians(25) * 1000 / 36
    expected = direct(kodak.scene, truth.Sensor(interval))
    got = kodak.value(network, PIXELS)
    np.testing.assert_allclose(got, expected, rtol=0, atol=1e-12 * np.abs(expected).max())


def test_overlap_areas_by_counting():
    """The chord integrals against counted points, and the disc's closed form."""
    fine = 1200  # shifts of whole points: straight edges lie on the points' borders
    x, y = np.meshgrid(*2 * [(np.arange(2 * fine) + 0.5) / fine * 50 - 50])

    def lit(aperture, x, y):
        square = x * x + y * y
        inside = (square <= aperture.radius**2) & (square >= aperture.inner**2)
        inside &= np.abs(x) >= aperture.half_bar
        return inside & (x >= 0) if aperture.half_moon else inside

    for shape, (_, aperture) in SHAPES.items():
        if aperture is None:
            continue
        here = lit(aperture, x, y)
        counted = np.mean(here & lit(aperture, x - 3.75, y - 1.875)) / np.mean(here)
        assert aperture.otf(3.75, 1.875) == pytest.approx(counted, abs=2e-4), shape
        assert aperture.otf(0.0, 0.0) == 1.0
    v = 0.3
    disc = 2 / math.pi * (math.acos(v) - v * math.sqrt(1 - v * v))
    assert truth.Aperture(45.0).otf(0.0, 90 * v) == pytest.approx(disc, abs=1e-14)
    assert truth.Aperture(45.0).otf(90 * v, 0.0) == pytest.approx(disc, abs=1e-14)


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
    done = subprocess.run(
        command("app.cli", *map(str, words)),
        cwd=tmp_path,
        env=environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (0, "")
