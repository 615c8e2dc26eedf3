"""How the benchmark judges, tells and draws its figures."""

from __future__ import annotations

import numpy as np
import pytest

from app.bench.measuring.bench_settings import Settings
from app.bench.measuring.bench_tables import Chart, Table, figure_text, verdict
from app.bench.measuring.timing import paired
from app.bench.pages import charts
from app.bench.pages.chart_labels import Label, place_labels
from app.bench.pages.chart_looks import drawing
from app.bench.pages.charts import chart_png
from app.bench.pages.markdown import END, START, fragment
from app.bench.speed.growth import judge_steps


@pytest.mark.parametrize(
    ("value", "reach", "aim", "told"),
    [
        (6.0, 5.0, 2.5, "missed: 1.20 × reach"),
        (5.004, 5.0, 2.5, "missed: 1.0008 × reach"),
        (4.0, 5.0, 2.5, "met; 1.60 × aim"),
        (2.5, 5.0, 2.5, "met, aim too"),
        (40.0, 50.0, None, "met"),
        (40.0, None, None, ""),
    ],
)
def test_verdict(value, reach, aim, told):
    assert verdict(value, reach, aim) == told


@pytest.mark.parametrize(
    ("value", "text"),
    [(None, "-"), (0.0, "0"), (1.234567, "1.23"), (3e-7, "3e-7"), (5, "5"), (1234.5, "1230"),
     (9.996e5, "1e6"), (2.5e9, "2.5e9"), (-4321.0, "-4320")],
)  # fmt: skip
def test_figure_text(value, text):
    assert figure_text(value) == text


def test_pairs_are_ratios_of_neighbours():
    units = iter([9.0, 1.0, 2.0, 4.0, 7.0, 5.0, 6.0])
    subjects = iter([9.0, 3.0, 4.0, 40.0])
    found = paired(lambda: next(subjects), lambda: next(units), pairs=3, warm_up=1)
    assert found.ratio == 3.0  # 3, 2 and 10
    assert (found.seconds, found.t0_seconds, found.alone_seconds) == (4.0, 2.0, 6.0)


def grown(*ratios, spread=0.01, first=512):
    return [
        {"size": first * 2**step, "t0": t0, "low": t0 - spread, "high": t0 + spread, "pairs": 9}
        for step, t0 in enumerate(ratios)
    ]


def test_growth_that_falls_in_every_step_is_met():
    rows = grown(3.0, 2.5, 2.4, 2.2, 2.1)
    assert judge_steps(rows) == (
        "Met, aim too: every step falls. From 512² to 8192², all that was measured: 0.70 ×."
    )
    assert [row.get("step_verdict") for row in rows] == [None, *["met: falls"] * 4]


def test_growth_that_rises_in_one_step_is_missed_though_the_ends_fall():
    rows = grown(3.0, 2.0, 2.2, 1.8, 1.5)
    told = judge_steps(rows)
    assert told.startswith("Missed: rises 1024² → 2048² by 10% ± ")
    assert "not increasing" not in told
    assert rows[2]["step_verdict"] == "missed: rises by 10%"
    assert rows[2]["step"] == pytest.approx(1.1)


def test_growth_that_the_spread_can_explain_is_undecided():
    """A rise of 2 %; quartiles 0.2 apart give each median an error of 0.06, 3 % of it."""
    rows = grown(2.0, 2.04, spread=0.1)
    assert judge_steps(rows).startswith("Undecided: rises 512² → 1024² by 2% ± 9%")
    assert rows[1]["step_verdict"] == "rises, within ±"
    assert rows[1]["margin"] == pytest.approx(
        2 * 1.253 * 0.2 / 1.349 / 3 / 2 * np.sqrt(2), rel=0.02
    )


def test_growth_is_judged_from_512_on():
    rows = grown(1.0, 5.0, 4.0, first=256)
    assert judge_steps(rows).startswith("Met")
    assert "step" not in rows[1]
    assert judge_steps(grown(1.0, 5.0, first=128)).startswith("Not judged")


ROWS = (
    {"choice": "a|b", "t0": 1.5, "error": 1e-3, "kind": "one"},
    {"choice": "c", "t0": 3.0, "error": 0.0, "kind": "one"},
    {"choice": "d", "t0": None, "error": 1e-9, "kind": "two"},
)
HEADS = {"choice": "choice", "t0": "T0", "error": "error", "kind": "kind"}


def table(rows=ROWS, **chart):
    drawn = Chart("t0", "error", "time (T0)", "error", "choice", **chart)
    return Table("t", "Title", HEADS, rows, "Text.", drawn, ("choice", "t0"), ("kind", "one"))


def test_fragment_holds_the_short_forms():
    facts = {
        "date": "2026-01-02 03:04 +0000",
        "machine": {"processor": "P", "cores": 4, "usable_cores": 2, "memory_bytes": 2**33,
                    "load": 0.25, "fft": "F", "versions": {"numpy": "2"}},
    }  # fmt: skip
    longer = Table("u", "Other", HEADS, ROWS)
    text = fragment(facts, {"speed": [table(), longer]}, Settings(("speed",)))
    lines = text.splitlines()
    assert (lines[0], lines[-1]) == (START, END)
    assert "on 2026-01-02: P, 2 of 4 cores, 8 GiB, load 0.2 at the start, numpy 2" in lines[2]
    assert lines[4:11] == [
        "**Title**", "", "| choice | T0 |", "| --- | ---: |", "| a\\|b | 1.5 |", "| c | 3 |", "",
    ]  # fmt: skip
    assert "Other" not in text


@pytest.mark.parametrize("chart", [{}, {"group": "choice"}, {"lines": True, "floor": (1e-5, "f")}])
def test_picture_of_what_was_measured(chart):
    drawn = chart_png(table(**chart))
    assert drawn is not None
    assert drawn.startswith(b"\x89PNG")
    # Told the same way twice, and not the same without its title.
    assert chart_png(table(**chart)) == drawn
    assert chart_png(table(**chart), titled=False) != drawn


def test_a_name_has_the_colour_of_its_points(monkeypatch):
    noted = []

    def placed(axis, labels, *others):
        noted.append((axis, labels))
        place_labels(axis, labels, *others)

    monkeypatch.setattr(charts, "place_labels", placed)
    rows = [
        {"choice": str(k), "t0": 1.0 + k, "error": 10.0**-k, "kind": "aabbc"[k]} for k in range(5)
    ]
    assert chart_png(table(rows, group="kind")) is not None
    ((axis, labels),) = noted
    colours = {tuple(line.get_xdata()): line.get_color() for line in axis.get_lines()}
    names = {label.text: label.colour for label in labels if label.bold}
    assert names == {
        "a": colours[1.0, 2.0], "b": colours[3.0, 4.0], "c": colours[(5.0,)],
    }  # fmt: skip
    assert len(set(names.values())) == 3


def test_no_picture_of_nothing():
    assert chart_png(table(ROWS[2:])) is None
    assert chart_png(Table("t", "Title", HEADS, ROWS)) is None
    assert chart_png(table(where=("kind", "three"))) is None


def test_words_hide_neither_marks_nor_each_other():
    """Points in a cluster: their words find free places inside the axes."""
    drawn_random = np.random.default_rng(4)
    points = [(float(x), float(y)) for x, y in drawn_random.uniform(0.4, 0.6, (9, 2))]
    points += [(0.0, 0.0), (1.0, 1.0)]
    with drawing(4.9, "Title") as (drawn, _):
        axis = drawn.subplots()
        axis.set(xlim=(0, 1), ylim=(0, 1))
        labels = [Label(f"word {number}", (place,), "k") for number, place in enumerate(points)]
        place_labels(axis, labels, points, [], [], 9.5)
        drawn.canvas.draw()
        boxes = np.array([text.get_window_extent().extents for text in axis.texts])
        marks = axis.transData.transform(points)
        frame = axis.get_window_extent().extents
    assert len(boxes) == len(points)
    for number, box in enumerate(boxes):
        assert np.all(box[:2] >= frame[:2] - 1)
        assert np.all(box[2:] <= frame[2:] + 1)
        assert not np.any(np.all((marks > box[:2]) & (marks < box[2:]), axis=1))
        for other in boxes[:number]:
            assert np.any(np.minimum(box[2:], other[2:]) <= np.maximum(box[:2], other[:2]))
