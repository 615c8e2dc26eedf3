"""A background run in a real process writes what the command writes, or nothing at all."""

import contextlib
import csv
import json
import re
import subprocess

import numpy as np
import pytest

from app.run.job import Job, Result, message_line, read_message
from app.run.terminal import command, environment
from child_process import PATIENCE_S


@contextlib.contextmanager
def started(job):
    """Its process, which has been given the job; it is stopped at the end."""
    with subprocess.Popen(
        command("app.command.run_job"),
        env=environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as child:
        try:
            child.stdin.write(message_line(job) + "\n")
            child.stdin.flush()
            yield child
        finally:
            child.kill()


def finished_job(job):
    """Exit code, result and standard error of a job; its input stays open to the end."""
    with started(job) as child:
        messages = [read_message(line.rstrip("\n")) for line in child.stdout]
        said = child.stderr.read()
        code = child.wait(PATIENCE_S)
    results = [message for message in messages if isinstance(message, Result)]
    return code, results[-1] if results else None, said


FOV = {"fov_x_deg": 3.0, "fov_y_deg": 2.5}
RUN = {"final.png", "mtf.csv", "readouts.json"}
TIMES = re.compile(r"\d{4}-\d\d-\d\d \d\d:\d\d [+-]\d{4}|\b\d+\.\d+ m?s\b")


@pytest.fixture
def job(tmp_path, small, write):
    """A job of the small network as it was saved, or of another one."""

    def make(kind, network=small, output="out", **given):
        path = tmp_path / write(network)
        text = path.read_text()
        return Job(kind, text, tmp_path, path, tmp_path / output, **given)

    return make


def names(folder):
    return {path.name for path in folder.iterdir()}


def with_files(small, *, write_to=None):
    """The small network of a picture that is read; perhaps one is written."""
    nodes = {**small["nodes"], "scene": {"module": "read_image", "params": dict(FOV)}}
    links = list(small["links"])
    if write_to is not None:
        nodes["write"] = {"module": "write_image", "params": {"path": str(write_to)}}
        links.append(["pixels.image", "write.image"])
    return {**small, "nodes": nodes, "links": links}


def test_the_report_is_the_commands_but_for_its_times(job, works, tmp_path):
    code, result, said = finished_job(job("report", output="mine.html"))
    assert (code, said) == (0, "")
    assert result.page == tmp_path / "mine.html"
    assert names(tmp_path) == {"net.json", "mine.html"}, "the report, and nothing else"
    works("run", "net.json", "--report", "theirs.html")
    mine, theirs = (
        TIMES.sub("TIME", (tmp_path / name).read_text()) for name in ("mine.html", "theirs.html")
    )
    assert mine.count("TIME") > 5
    assert mine == theirs


def test_one_run_writes_what_the_command_writes(job, imagechain, tmp_path):
    code, result, said = finished_job(job("run", report=True))
    assert (code, said) == (0, "")
    assert result.page == tmp_path / "out" / "report.html"
    assert result.previews[0][1].startswith(b"\x89PNG")
    imagechain("run", "net.json", "--output-dir", "theirs")
    assert names(tmp_path / "out") == RUN | {"report.html"}
    for name in RUN:
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "theirs" / name).read_bytes()


def test_a_sweep_writes_runs_and_the_trade_off(job, imagechain, works, tmp_path):
    values = (0.1, 0.3, -2.0)
    code, result, said = finished_job(job("sweep", target="blur.sigma_x_mrad", values=values))
    assert (code, said) == (0, "")
    ((failed, why),) = result.failures
    assert failed == "blur.sigma_x_mrad=-2"
    assert why == "blur: sigma_x_mrad = -2.0 mrad is not allowed: must be a number of at least 0"
    assert result.runs == 3
    folder = tmp_path / "out"
    runs = {f"blur.sigma_x_mrad={value}" for value in (0.1, 0.3)}
    assert names(folder) == {*runs, "tradeoff.html", "tradeoff.csv"}
    for value in (0.1, 0.3):
        setting = f"blur.sigma_x_mrad={value}"
        imagechain("run", "net.json", "--set", setting, "--output-dir", f"theirs{value}")
        for name in RUN:
            theirs = tmp_path / f"theirs{value}" / name
            assert (folder / setting / name).read_bytes() == theirs.read_bytes()
    vary = f"blur.sigma_x_mrad={','.join(map(str, values))}"
    works("tradeoff", "net.json", "--vary", vary, "--output", "theirs.csv")
    assert (folder / "tradeoff.csv").read_text() == (tmp_path / "theirs.csv").read_text()


def test_frames_are_the_commands(job, imagechain, tmp_path):
    code, _, said = finished_job(job("frames", frames=3))
    assert (code, said) == (0, "")
    save = ["--save", "pixels.image=theirs.npy", "--output-dir", "theirs"]
    imagechain("run", "net.json", "--frames", "3", *save)
    frames = np.load(tmp_path / "out" / "frames.npy")
    assert frames.shape == (3, 20, 24)
    assert np.array_equal(frames, np.load(tmp_path / "theirs.npy"))
    assert names(tmp_path / "out") == RUN | {"frames.npy"}


def test_files_are_run_one_by_one_and_the_damaged_ones_are_named(job, small, tmp_path):
    for number in (1, 2):
        np.save(tmp_path / f"scene{number}.npy", np.full((8, 10), float(number)))
    (tmp_path / "broken.npy").write_bytes(b"no picture")
    network = with_files(small, write_to="product.npy")
    files = [str(tmp_path / f"{name}.npy") for name in ("scene1", "broken", "scene2")]
    code, result, said = finished_job(
        job("files", network, target="scene.path", values=tuple(files))
    )
    assert (code, said) == (0, "")
    ((failed, why),) = result.failures
    assert failed == "broken"
    assert "broken.npy" in why
    folder = tmp_path / "out"
    assert names(folder) == {"scene1", "scene2", "readouts.csv"}
    for number in (1, 2):
        own = folder / f"scene{number}"
        assert names(own) == RUN | {"product.npy"}, "what nodes write goes to the run's folder"
        made = np.load(own / "product.npy")
        assert made == pytest.approx(np.full((4, 5), float(number)), rel=1e-5)
    with (folder / "readouts.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["run"] for row in rows] == ["scene1", "scene2"]
    read = json.loads((folder / "scene2" / "readouts.json").read_text())["init"]
    numbers = {f"init.{name}": value for name, value in read.items() if value is not None}
    assert numbers
    assert {name: float(rows[1][name]) for name in numbers} == pytest.approx(numbers)


def test_a_node_writes_elsewhere_only_where_that_was_chosen(job, small, tmp_path_factory):
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "made.npy"
    network = {**with_files(small, write_to=elsewhere)}
    network["nodes"]["scene"] = small["nodes"]["scene"]
    code, _, said = finished_job(job("run", network))
    assert code == 2
    assert said == (
        f"imagechain: write: cannot write {elsewhere}: the file lies outside the network's folder "
        "and the output folder; choose the file with Browse… on the node's control panel, or "
        "choose another output folder\n"
    )
    assert not elsewhere.exists()
    code, _, said = finished_job(job("run", network, chosen=(elsewhere,)))
    assert (code, said) == (0, "")
    assert elsewhere.exists()


def test_stopped_it_leaves_nothing(job, tmp_path):
    """As at Cancel, or when the editor is killed: its input ends then."""
    running = job("frames", output="new/out", frames=100_000)
    with started(running) as child:
        for line in child.stdout:
            message = read_message(line.rstrip("\n"))
            if isinstance(message, tuple) and message[1].startswith("frames"):
                break
        assert any(path.name.startswith(".imagechain-") for path in tmp_path.iterdir())
        child.stdin.close()
        child.stdin = None
        code = child.wait(PATIENCE_S)
        said = child.stderr.read()
    assert (code, said) == (1, "imagechain: cancelled; nothing was written\n")
    assert names(tmp_path) == {"net.json"}
