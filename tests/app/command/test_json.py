"""``--json``: the result of each command on standard output, in the words of its files."""

import json

import numpy as np
import pytest

from app.bench.timing import STEADY
from app.command.cli import COMMANDS
from edge_truth import blur_network, gaussian_edge

BLUR = ["--vary", "blur.sigma_x_mrad=0.1,0.2"]
LEVEL = "total.mtf_nyquist_x"
# Words, a file of the same content, and what the result has.
RESULTS = {
    "run": (["net.json"], None, {"figures", "readouts", "warnings", "skipped", "way", "files"}),
    "check": (["net.json"], None, {"errors", "warnings"}),
    "tradeoff": (["net.json", *BLUR, "--output", "t.json"], "t.json", {"network", "curves"}),
    "study": (["net.json", *BLUR, "--jobs", "1", "--output", "s.csv"], None, {"rows", "files"}),
    "solve": (
        ["net.json", "--for", "blur.sigma_x_mrad=0.001:1", "--until", f"{LEVEL}=0.5"],
        None,
        {"parameter", "value", "figure", "readouts"},
    ),
    "measure": (["edge.npy"], None, {"format", "edges"}),
    "fit": (
        ["net.json", "--to", "edge.npy", "--free", "blur.sigma_x_mrad=0.01:0.3"],
        None,
        {"parameters", "correlation"},
    ),
    "photon-transfer": (
        ["cold.npy", "hot.npy", "--offset-dn", "0", "--output", "p.json"],
        "p.json",
        {"figures", "levels"},
    ),
    "netd": (
        ["cold.npy=290K", "hot.npy=300K", "--output", "n.json"], "n.json", {"figures", "levels"}
    ),
    "networks": ([], None, None),
    "modules": (["jitter_mtf"], None, None),
    "presets": (["sentinel"], None, None),
    "bench": (["--only", "precision", "--quick", "--size", "32"], None, {"parts", "machine"}),
    "handbook": (["--html", "book"], None, {"page"}),
}  # fmt: skip


@pytest.fixture
def _files(tmp_path, monkeypatch):
    network = blur_network(blur=("gaussian_mtf", {"sigma_x_mrad": 0.2, "sigma_y_mrad": 0.05}))
    (tmp_path / "net.json").write_text(json.dumps(network))
    edge = gaussian_edge(
        angle_deg=6.0, sigma=(0.6, 0.5), shape=(64, 64), levels=(1000, 4000), noise=20.0, seed=5
    )
    np.save(tmp_path / "edge.npy", edge)
    random = np.random.default_rng(1)
    for name, level in (("cold", 900.0), ("hot", 2000.0)):
        np.save(tmp_path / f"{name}.npy", random.normal(level, level**0.5, (8, 24, 32)))
    for name, value in STEADY.items():  # the bench starts itself again without
        monkeypatch.setenv(name, value)


SLOW = pytest.param("handbook", marks=pytest.mark.thorough)


@pytest.mark.usefixtures("_files")
@pytest.mark.parametrize(
    "command", [*(name for name in COMMANDS if name not in ("edit", "handbook")), SLOW]
)
def test_the_result_and_nothing_else(command, works, tmp_path):
    words, file, keys = RESULTS[command]
    done = works(command, *words, "--json")
    facts = json.loads(done.stdout)
    if keys is None:
        assert all("name" in one or "key" in one for one in facts)
    else:
        assert keys <= set(facts)
    if file is not None:
        assert facts == json.loads((tmp_path / file).read_text())


@pytest.mark.usefixtures("_files")
def test_it_has_the_words_of_the_files(imagechain, tmp_path):
    run = json.loads(imagechain("run", "net.json", "--report", "r.json", "--json").stdout)
    assert run["readouts"] == json.loads((tmp_path / "net-output/readouts.json").read_text())
    report = json.loads((tmp_path / "r.json").read_text())
    assert [run[name] for name in ("figures", "warnings")] == [
        report[name] for name in ("figures", "warnings")
    ]
    assert all((tmp_path / name).is_file() for name in run["files"])
    words = ("study", "net.json", *BLUR, "--jobs", "1", "--output", "s.csv", "--json")
    (first, second) = json.loads(imagechain(*words).stdout)["rows"]
    heads = (tmp_path / "s.csv").read_text().splitlines()[0]
    assert list(first) == heads.split(",")
    assert [row["blur.sigma_x_mrad (mrad)"] for row in (first, second)] == [0.1, 0.2]


@pytest.mark.usefixtures("_files")
def test_errors_are_in_it_too(imagechain):
    done = imagechain("check", "net.json", "--set", "blur.sigma_x_mrad=-1", "--json")
    assert done.returncode == 2
    assert done.stderr.count("\n") == 1
    (error,) = json.loads(done.stdout)["errors"]
    assert error["node"] == "blur"


@pytest.mark.usefixtures("_files")
def test_a_file_is_still_written(imagechain, tmp_path):
    done = imagechain("measure", "edge.npy", "--json", "m.json")
    assert json.loads((tmp_path / "m.json").read_text())["edges"]
    assert not done.stdout.startswith("{")
