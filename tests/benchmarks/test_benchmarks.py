"""What builders measure: it judges and tells as it should; no timings."""

import sys

import numpy as np
import pytest

import page
import scanning
from app.bench.tables import Chart, Table
from blocks import frame_plan, scenes_plan
from child_process import ROOT, finished
from growth import judge_steps
from scanning import Scanner


def test_the_command_measures_the_parts_that_are_named():
    words = [sys.executable, "tests/benchmarks/run.py", "--quick", "--size", "64"]
    for part in ("scanning", "cameras"):
        words += ["--only", part]
    done = finished(words, folder=ROOT)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Line scanner" in done.stdout
    assert "Frames of a camera" in done.stdout


def test_growth_that_rises_in_one_step_is_missed_though_the_ends_fall():
    rows = [
        {"size": 512 * 2**step, "t0": t0, "low": t0 - 0.01, "high": t0 + 0.01, "pairs": 9}
        for step, t0 in enumerate((3.0, 2.0, 2.2, 1.8, 1.5))
    ]
    told = judge_steps(rows)
    assert told.startswith("Missed: rises 1024² → 2048² by 10% ± ")
    assert rows[2]["step_verdict"] == "missed: rises by 10%"
    assert rows[2]["step"] == pytest.approx(1.1)


def test_scenes_of_a_plan():
    """By hand: 2¹⁸ samples a scene, 100 ns each."""
    plan = scenes_plan(100.0, 10**6, 512, 64)
    assert plan["core_hours"] == pytest.approx(262144e6 * 100e-9 / 3600)  # 7.28
    assert plan["hours"] == pytest.approx(plan["core_hours"] / 64)
    assert plan["disk_GB"] == pytest.approx(2 * 4 * 262144e-3)
    assert plan["memory_GB"] == pytest.approx(64 * 8 * 2**20 / 1e9)  # eight pictures of 1 MiB each


def test_a_frame_waits_for_computing_or_for_the_disk():
    slow = frame_plan(100.0, 25.0, 12.0, 10**5, 2)
    assert (slow["limit"], slow["hours"]) == ("computing", pytest.approx(1e10 * 100e-9 / 2 / 3600))
    fast = frame_plan(100.0, 25.0, 12.0, 10**5, 16)
    assert (fast["limit"], fast["hours"]) == ("the disk", pytest.approx(1e10 * 25 / 1e9 / 3600))
    assert fast["disk_GB"] == pytest.approx(10 * (8 + 12))


def test_a_table_in_markdown_goes_between_the_marks():
    rows = [{"choice": "a|b", "size": 8, "t0": 1.5}, {"choice": "c", "size": 9, "t0": 3.0}]
    heads = {"choice": "choice", "t0": "T0"}
    table = Table("t", "Title", heads, rows, "Text.", Chart("error", where=("size", 8)))
    told = page.markdown(table)
    lines = ["**Title**", "", "| choice | T0 |", "| --- | ---: |", "| a\\|b | 1.5 |", "", "Text."]
    assert told.splitlines() == lines
    before = f"# Größe\n\n{page.START}\nold\n{page.END}\n\nrest\n"
    assert page.inserted(before, "new") == "# Größe\n\nnew\n\nrest\n"
    with pytest.raises(SystemExit):
        page.inserted("# no marks", "new")


@pytest.mark.parametrize("aperture", [True, False])
@pytest.mark.parametrize("field", scanning.FIELDS_DEG)
def test_line_by_line_is_the_direct_sum(field, aperture):
    scanner = Scanner(36, field, aperture, "double")
    columns, expected = scanner.expected()
    atol = 1e-12 * np.abs(expected).max()
    direct = scanner.line_by_line("direct")[:, columns]
    np.testing.assert_allclose(direct, expected, rtol=0, atol=atol)
    # One scale errs visibly at the ends of the scan, and blended scales close in on the truth.
    whole, two, four = (
        np.abs(picture[:, columns] - expected).max()
        for picture in (scanner.whole(), *(scanner.line_by_line("nodes", n) for n in (2, 4)))
    )
    assert whole > 10 * two
    assert four < 1e-5 * np.abs(expected).max()
    if aperture:
        assert two > four
    else:
        assert two < atol
