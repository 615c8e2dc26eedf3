"""A study by several processes: its rows, what a process that ends costs, who can reach it."""

import contextlib
import os
import signal
import socket
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from child_process import PATIENCE_S, ROOT, finished, wait_for

WORDS = ["--vary=blur.sigma_x_mrad=0:1:8", "--vary=electronics.d_star=1e10:1e12:5:log"]
WORDS += ["--figure=total.mtf_nyquist_x", "--figure=electronics.snr"]
# A worker whose points do something before they are computed.
WORKER = """
import os, sys, time
from app.study import study_rows, worker_processes
row = study_rows.RowMaker.row
def slow(self, task, cancel=None):
    {before}
    return row(self, task, cancel)
study_rows.RowMaker.row = slow
worker_processes.main()
"""
PROGRAM = """
import sys
from app.study import worker_processes
worker_processes.command = lambda _: [sys.executable, "-P", "-c", {worker!r}]
from app.command.cli import main
sys.exit(main())
"""
pytestmark = pytest.mark.skipif(not Path("/proc/self/fd").exists(), reason="it looks into /proc")


@pytest.fixture
def begun(sensor, tmp_path):
    """Start a study of slow points; its whole tree is ended with the test."""
    children = []

    def start(output, *more, before="time.sleep(0.05)"):
        program = PROGRAM.format(worker=WORKER.format(before=before))
        child = subprocess.Popen(
            [sys.executable, "-c", program, "study", sensor, *WORDS, "--jobs=2",
             f"--output={output}", *more],
            cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        children.append(child)
        journal = tmp_path / f"{output}.journal"
        wait_for(lambda: journal.exists() and len(_lines(journal)) > 4, "rows", child=child)
        return child

    yield start
    for child in children:
        for process in [child.pid, *workers_of(child.pid)]:
            with contextlib.suppress(ProcessLookupError):
                os.kill(process, signal.SIGKILL)
        child.communicate()


def workers_of(pid):
    """The processes that a process has started."""
    path = Path(f"/proc/{pid}/task")
    with contextlib.suppress(OSError):
        return [int(p) for t in path.iterdir() for p in (t / "children").read_text().split()]
    return []


def _lines(path):
    return path.read_bytes().splitlines()


def _is_there(pid):
    with contextlib.suppress(OSError):
        return Path(f"/proc/{pid}/stat").read_text().rpartition(") ")[2][0] != "Z"
    return False


def test_the_same_rows_as_of_one_process(sensor, works, rows_of, tmp_path):
    save = "--save=back.image=out{}/{{point}}.npy"
    for jobs in "12":
        words = [f"--jobs={jobs}", f"--output={jobs}.csv", save.format(jobs)]
        works("study", sensor, *WORDS, *words)
    assert rows_of("1.csv") == rows_of("2.csv")
    for number in range(1, 41):
        one, two = (np.load(tmp_path / f"out{n}" / f"{number:02}.npy") for n in "12")
        assert np.array_equal(one, two)


def test_killed_workers_cost_no_row(sensor, begun, imagechain, rows_of):
    child = begun("b.csv")
    for worker in workers_of(child.pid):
        os.kill(worker, signal.SIGKILL)
    out, line = child.communicate(timeout=PATIENCE_S)
    assert (child.returncode, line) == (0, "")
    assert out.startswith("40 points in ")
    imagechain("study", sensor, *WORDS, "--output=a.csv", "--jobs=1")
    assert rows_of("b.csv") == rows_of("a.csv")


def test_a_point_that_ends_its_process_is_a_row_and_costs_no_other(sensor, imagechain, rows_of, monkeypatch):  # fmt: skip  # noqa: E501
    deadly = WORKER.format(before="if task[0] == 11: os.kill(os.getpid(), 9)")
    imagechain("study", sensor, *WORDS, "--output=a.csv", "--jobs=1")
    monkeypatch.setattr(
        "app.study.worker_processes.command", lambda _: [sys.executable, "-P", "-c", deadly]
    )
    done = imagechain("study", sensor, *WORDS, "--output=b.csv", "--jobs=2")
    assert done.returncode == 2
    assert done.stderr == (
        "imagechain: 1 of 40 points failed (see the column error in b.csv); the first is point 12: "
        "the process computing this point stopped 3 times\n"
    )
    expected, rows = rows_of("a.csv"), rows_of("b.csv")
    assert rows[11]["error"]
    del expected[11], rows[11]
    assert rows == expected


def test_stopped_it_says_what_is_kept_and_goes_on(sensor, begun, imagechain, rows_of, tmp_path):
    child = begun("b.csv")
    workers = workers_of(child.pid)
    child.send_signal(signal.SIGTERM)
    out, line = child.communicate(timeout=PATIENCE_S)
    assert (child.returncode, out) == (1, "")
    kept = len(_lines(tmp_path / "b.csv.journal")) - 1
    assert line == (
        f"imagechain: stopped; {kept} of 40 points done and saved in b.csv.journal. Give "
        "the same command again to resume\n"
    )
    assert len(workers) == 2
    assert not any(map(_is_there, workers))
    assert imagechain("study", sensor, *WORDS, "--output=b.csv", "--jobs=2").returncode == 0
    imagechain("study", sensor, *WORDS, "--output=a.csv", "--jobs=1")
    assert rows_of("b.csv") == rows_of("a.csv")


def test_a_killed_study_leaves_no_process(begun):
    """Also where a worker is within a point that takes longer than anybody waits."""
    child = begun("b.csv", before="time.sleep(0.05 if task[0] < 30 else 99)")
    workers = workers_of(child.pid)
    assert len(workers) == 2
    child.kill()
    wait_for(lambda: not any(map(_is_there, workers)), "the workers' end", seconds=60)


def listening(pids):
    """Addresses of the sockets that wait for others in these processes."""
    links = []
    for pid in pids:
        for file in Path(f"/proc/{pid}/fd").iterdir():
            with contextlib.suppress(OSError):
                links.append(str(file.readlink()))
    sockets = {link[8:-1] for link in links if link.startswith("socket:[")}
    found = []
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            cells = line.split()
            if cells[9] in sockets and cells[3] == "0A":
                found.append(("127.0.0.1", int(cells[1].rpartition(":")[2], 16)))
    for line in Path("/proc/net/unix").read_text().splitlines()[1:]:
        cells = line.split()
        if cells[6] in sockets and int(cells[3], 16) & 0x10000:
            found.append(cells[7] if len(cells) > 7 else "without a name")
    return found


def test_no_other_user_reaches_a_running_study(begun):
    """The workers run code that comes by a connection: that must be a pipe of their own."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        assert server.getsockname() in listening([os.getpid()])
    child = begun("b.csv", before="time.sleep(0.3)")
    tree = [child.pid, *workers_of(child.pid)]
    assert len(tree) == 3
    assert listening(tree) == []
    for pid in tree[1:]:
        links = [str(file.readlink()) for file in Path(f"/proc/{pid}/fd").iterdir()]
        assert any(link.startswith("pipe:") for link in links)
        assert not any(link.startswith("socket:") for link in links)


@pytest.fixture(scope="module")
def traps(tmp_path_factory):
    """A folder with a file of the name of everything that a child imports; each leaves a mark."""
    folder = tmp_path_factory.mktemp("traps")
    names = set(sys.stdlib_module_names) | {
        "numpy", "scipy", "distributed", "dask", "app", "core", "nodes", "networks", "imagechain",
        "matplotlib", "rich", "jinja2", "PySide6", "OpenImageIO", "sitecustomize", "usercustomize",
    }  # fmt: skip
    for name in names:
        (folder / f"{name}.py").write_text(
            f"open({str(folder / 'marks')!r}, 'a').write({name!r} + '\\n')\n"
        )
    return folder


def test_the_traps_catch(traps):
    """What the next tests rely on: a child that searches the folder is caught."""
    finished([sys.executable, "-c", "import json"], folder=traps)
    assert "json" in (traps / "marks").read_text()
    (traps / "marks").unlink()


def test_a_study_imports_nothing_of_the_current_folder(traps, write, sensor, tmp_path):
    words = ["study", str(tmp_path / sensor), *WORDS, "--jobs=2", f"--output={tmp_path / 'a.csv'}"]
    program = "import sys; from app.command.cli import main; sys.exit(main())"
    variables = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = finished([sys.executable, "-P", "-c", program, *words], folder=traps, env=variables)
    assert (done.returncode, done.stderr) == (0, "")
    assert not (traps / "marks").exists()


def test_nothing_else_starts_a_python():
    """Each place that starts a process does it with the command of `app.run.terminal`."""
    starts = ("sys.executable", "multiprocessing", "ProcessPoolExecutor", "os.fork(", "spawnv")
    places = {
        str(file.relative_to(ROOT))
        for layer in ("core", "nodes", "app", "imagechain")
        for file in (ROOT / layer).rglob("*.py")
        if any(word in file.read_text(encoding="utf-8") for word in starts)
    }
    # The benchmark runs what `terminal` gives; own_packages looks at its own process.
    assert places == {"app/run/terminal.py", "app/bench/timing.py", "imagechain/own_packages.py"}
