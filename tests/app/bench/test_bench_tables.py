"""How the benchmark judges, tells and draws its figures."""

import pytest

from app.bench.tables import Chart, Table, chart_png, figure_text, verdict
from app.bench.timing import paired


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
