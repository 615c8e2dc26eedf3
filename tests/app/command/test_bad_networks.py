"""Faults of networks and of their inputs: exit code 2, one line that names it, nothing written."""

import os

import numpy as np
import pytest

from child_process import ROOT


@pytest.fixture(autouse=True)
def _network(write, small):
    write(small)


NETWORKS = {
    "unknown module": (lambda n: n["nodes"]["blur"].update(module="blurr"), "blurr"),
    "missing input": (lambda n: n["links"].pop(), "pixels"),
    "format": (lambda n: n.update(format="other"), "format"),
    "final": (lambda n: n.update(final="nothing.image"), "final"),
}


@pytest.mark.parametrize(("change", "told"), NETWORKS.values(), ids=NETWORKS.keys())
def test_network(change, told, fails, write, small):
    change(small)
    write(small)
    assert told in fails("run", "net.json")


@pytest.mark.parametrize("text", ["", "[]", "[" * 10**5, "\x00\xff"])
def test_not_a_network(text, fails, tmp_path):
    (tmp_path / "net.json").write_bytes(text.encode("latin-1"))
    assert "net.json" in fails("run", "net.json")


@pytest.mark.parametrize("count", [1, 2, 3])
def test_tells_how_many_more(fails, imagechain, write, small, count):
    wrong = [("blur", "sigma_x_mrad"), ("blur", "sigma_y_mrad"), ("jitter", "sigma_mrad")]
    for node, name in wrong[:count]:
        small["nodes"][node]["params"][name] = -1
    write(small)
    line = fails("run", "net.json")
    told = f" (and {count - 1} more: imagechain check lists them)\n"
    assert line.endswith(told) if count > 1 else "more:" not in line
    done = imagechain("check", "net.json")
    assert done.returncode == 2
    assert len(done.stdout.splitlines()) == count
    first = "blur: sigma_x_mrad = -1 mrad is not allowed: must be a number of at least 0"
    found = "1 error" if count == 1 else f"{count} errors"
    assert done.stderr == f"imagechain: net: {found}, the first: {first}\n"


def read_image(document, path):
    document["nodes"]["scene"] = {
        "module": "read_image",
        "params": {"path": path, "fov_x_deg": 3.0, "fov_y_deg": 2.5},
    }


def test_samples_not_finite(fails, write, small, tmp_path):
    frame = np.ones((40, 48), np.float32)
    frame[3, 7], frame[9, 1] = np.nan, np.inf
    np.save(tmp_path / "frame.npy", frame)
    read_image(small, "frame.npy")
    write(small)
    line = fails("run", "net.json")
    assert "2 samples" in line
    assert "row 3, column 7" in line


PLUG_IN = '''
from imagechain.plug_in import Image, ImageOutput, Module


class Filter(Module, key="faulty_glass.filter", title="Filter", group="Filters"):
    """Fail."""

    def run(self, image: Image) -> ImageOutput:
        return ImageOutput(1 / 0)


MODULES = (Filter,)
'''


def test_a_fault_of_a_plug_in_is_exit_code_1(imagechain_process, write, small, tmp_path):
    """Of every command: it is not the input's."""
    (tmp_path / "faulty_glass.py").write_text(PLUG_IN)
    about = tmp_path / "faulty_glass-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: faulty-glass\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[imagechain.modules]\nall = faulty_glass:MODULES\n")
    small["nodes"]["glass"] = {"module": "faulty_glass.filter"}
    small["links"] += [["scene.image", "glass.image"]]
    network, environment = write(small), {"PYTHONPATH": f"{ROOT}{os.pathsep}{tmp_path}"}
    vary = ("--vary", "blur.sigma_x_mrad=0.1,0.2", "--jobs", "1", "--output", "s.csv")
    study = ("study", network, *vary, "--save", "glass.image={point}.npy")
    for words in (("run", network), ("check", network), study):
        done = imagechain_process(*words, env=environment)
        assert (done.returncode, done.stderr.count("\n")) == (1, 1), done.stderr
        assert "a fault in the module faulty_glass.filter of the plug-in" in done.stderr
