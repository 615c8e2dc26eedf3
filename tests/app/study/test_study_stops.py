"""A study that is killed, or whose disk is full: what is left, and that it goes on from there."""

import json
import os
import subprocess
import sys

import pytest

from child_process import PATIENCE_S, ROOT, wait_for

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
    assert "--fresh discards it" in other.stderr
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
    assert "of 200 points are done and saved in a.csv.journal" in line
    assert line.count("\n") == 1
    content = (tmp_path / "a.csv.journal").read_bytes()
    assert content.endswith(b"\n")
    assert int(line.split("; ")[1].split()[0]) == content.count(b"\n") - 1 > 50
    assert not (tmp_path / "a.csv").exists()
