"""The journal: what is kept of an unfinished study, and what a torn or foreign one is worth."""

import pytest

from app.study.point_rows import Row
from app.study.study_journal import Journal
from core.errors import FileError, UsageError

ROWS = [Row(place, (0.1 * place, None), f"k{place}", 0.5, "why, »so«" if place == 2 else "",
            ("one; »two«", "three") if place == 1 else ())
        for place in range(4)]  # fmt: skip


@pytest.fixture
def kept(tmp_path):
    output = tmp_path / "rows.csv"
    with Journal(output, "study", 4) as journal:
        journal.add(ROWS[:3])
    return output, journal.path


def rows(output, **more):
    with Journal(output, "study", 4, **more) as journal:
        return dict(journal.rows)


def test_rows_come_back_as_they_were(kept):
    output, _ = kept
    assert rows(output) == {row.place: row for row in ROWS[:3]}
    assert rows(output, fresh=True) == {}


def test_wherever_it_is_cut_whole_rows_stay_and_the_rest_can_be_added(kept):
    output, path = kept
    content = path.read_bytes()
    lines = content.splitlines(keepends=True)
    for end in range(0, len(content), 5):
        path.write_bytes(content[:end])
        whole = sum(len(b"".join(lines[: n + 1])) <= end for n in range(1, 4))
        with Journal(output, "study", 4) as journal:
            assert list(journal.rows) == list(range(whole))
            journal.add(ROWS[whole:])
        assert rows(output) == {row.place: row for row in ROWS}


@pytest.mark.parametrize("damaged", [b'"k7"', b'"k\xff"'])
def test_a_damaged_row_does_not_count(kept, damaged):
    output, path = kept
    path.write_bytes(path.read_bytes().replace(b'"k1"', damaged))
    assert list(rows(output)) == [0, 2]


def test_another_study_is_refused(kept):
    output, path = kept
    before = path.read_bytes()
    with pytest.raises(UsageError, match="3 rows in rows"), Journal(output, "other", 4):
        pass
    assert path.read_bytes() == before


def test_two_studies_do_not_write_one_output(kept):
    output, _ = kept
    with (
        Journal(output, "study", 4),
        pytest.raises(FileError, match="another study is writing it"),
        Journal(output, "study", 4),
    ):
        pass
    assert sorted(path.name for path in output.parent.iterdir()) == ["rows.csv.journal"]
