"""Studies in the benchmark: every subject does the same work, and says what it took."""

from __future__ import annotations

import pytest

from app.bench.scale.study_scale import points_table, scenes_table


@pytest.mark.parametrize(
    "table", [lambda: points_table(32, 3, (1,)), lambda: scenes_table(32, 9, (1,))]
)
def test_a_study_beside_the_loop(table):
    loop, study = table().rows
    assert (loop["count"], study["count"]) == (9, 9)
    assert loop["ratio"] == 1.0
    assert study["ratio"] == pytest.approx(study["seconds"] / loop["seconds"])
    assert study["start"] is None
    assert study["reach"] in (1.3, 1.2)
