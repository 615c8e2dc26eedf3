"""The journal: what is kept of an unfinished study, and what a torn or foreign one is worth."""

import json
import os
import subprocess
import sys

import pytest

from app.study.study_rows import Journal, Row
from child_process import PATIENCE_S, ROOT, wait_for
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
        pytest.raises(FileError, match="another study is writing this file"),
        Journal(output, "study", 4),
    ):
        pass
    assert sorted(path.name for path in output.parent.iterdir()) == ["rows.csv.journal"]


# --- stops ---

WORDS = ["--vary=blur.sigma_x_mrad=0:1:20", "--vary=electronics.d_star=1e10:1e12:10:log"]
WORDS += ["--figure=electronics.ner", "--figure=electronics.snr", "--jobs=1"]


def begun(sensor, folder, *more, program="from app.command.cli import main; import sys; sys.exit(main())"):  # fmt: skip  # noqa: E501
    command = [sys.executable, "-c", program, "study", sensor, *WORDS, *more]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        command, cwd=folder, env=environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
        text=True,
    )  # fmt: skip


def test_killed_it_goes_on_with_the_same_rows(sensor, imagechain, works, rows_of, tmp_path):
    imagechain("study", sensor, *WORDS, "--output=whole.csv")
    journal = tmp_path / "a.csv.journal"
    child = begun(sensor, tmp_path, "--output=a.csv")
    wait_for(lambda: journal.exists() and journal.stat().st_size > 3000, "rows", child=child)
    child.kill()
    child.communicate(timeout=PATIENCE_S)
    kept = journal.read_bytes()
    assert not (tmp_path / "a.csv").exists()
    assert 20 < kept.count(b"\n") < 200
    other = imagechain("study", sensor, *WORDS, "--precision=double", "--output=a.csv")
    assert other.returncode == 2
    assert "--fresh discards these rows" in other.stderr
    assert journal.read_bytes() == kept
    works("study", sensor, *WORDS, "--output=a.csv")
    assert rows_of("a.csv") == rows_of("whole.csv")
    # What was kept is not computed again: the seconds are those of the first go.
    seconds = {line.split(",")[0]: line.split(",")[-3] for line in _lines(tmp_path / "a.csv")}

    for line in kept.splitlines()[1:-1]:
        place, _, _, took, _, _ = json.loads(line.partition(b" ")[2])
        assert float(seconds[str(place + 1)]) == took
    assert not [path for path in tmp_path.iterdir() if "journal" in path.name]


def _lines(path):
    return path.read_text(encoding="utf-8").splitlines()[1:]


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_a_full_disk_ends_it_with_one_line_and_what_is_done_stays(sensor, imagechain, rows_of, tmp_path):  # fmt: skip  # noqa: E501
    limited = (
        "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (9000, 9000)); "
        "from app.command.cli import main; sys.exit(main())"
    )
    child = begun(sensor, tmp_path, "--output=a.csv", program=limited)
    out, line = child.communicate(timeout=PATIENCE_S)
    assert (child.returncode, out) == (2, "")
    assert line.startswith("imagechain: cannot write a.csv.journal: File too large; ")
    assert "of 200 points done and saved in a.csv.journal" in line
    assert line.count("\n") == 1
    content = (tmp_path / "a.csv.journal").read_bytes()
    assert content.endswith(b"\n")
    assert int(line.split("; ")[1].split()[0]) == content.count(b"\n") - 1 > 50
    assert not (tmp_path / "a.csv").exists()
