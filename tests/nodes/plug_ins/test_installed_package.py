"""A package with modules of its own, installed for real: command, editor and Python see them."""

import csv
import json
import os
import shutil
import site
import subprocess
import sys
import venv
from pathlib import Path

import numpy as np
import pytest

from child_process import ROOT, finished
from command_line import run_here

EXAMPLE = ROOT / "tests" / "example_plug_in"
SHARE, SIGMA = 0.2, 3.0
NETWORK = {
    "format": "imagechain-network",
    "version": 1,
    "nodes": {
        "scene": {"module": "test_scene", "params": {"width": 32, "height": 24}},
        "filter": {"module": "imagechain_glare.neutral_filter", "params": {"optical_density": 1}},
        "init": {"module": "init_trans"},
        "glare": {
            "module": "imagechain_glare.glare_mtf",
            "params": {"scattered_share": SHARE, "halo_sigma_mrad": SIGMA},
        },
        "back": {"module": "back_transform"},
    },
    "links": [
        ["scene.image", "filter.image"],
        ["filter.image", "init.image"],
        ["init.context", "glare.context"],
        ["init.magnitude", "glare.magnitude"],
        ["glare.magnitude", "back.magnitude"],
        ["init.phase", "back.phase"],
    ],
}


@pytest.fixture(scope="module")
def fresh(tmp_path_factory):
    """Python of an environment of its own, in which the example is installed beside ours."""
    folder = tmp_path_factory.mktemp("fresh")
    venv.create(folder, with_pip=False, symlinks=True)
    python = folder / "bin" / "python"
    (own,) = folder.glob("lib/python*/site-packages")
    ours = [path for path in site.getsitepackages() if Path(path).is_dir()]
    (own / "ours.pth").write_text("".join(f"import site; site.addsitedir({p!r})\n" for p in ours))
    source = shutil.copytree(EXAMPLE, tmp_path_factory.mktemp("source") / "glare")  # is built there
    installed(python, source)
    return python


def installed(python, source):
    install = ["-m", "pip", "--python", python, "install", "-q", "--no-deps", source]
    subprocess.run([sys.executable, *map(str, install)], check=True, timeout=600)


@pytest.fixture
def network(tmp_path):
    path = tmp_path / "glare.json"
    path.write_text(json.dumps(NETWORK), encoding="utf-8")
    return path


def ran(python, *words, folder, env=()):
    """A process that finds our packages where these tests do, and no other folder."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), **dict(env)}
    done = finished([str(python), "-P", *map(str, words)], folder=folder, env=environment)
    assert done.returncode == 0, done.stderr
    return done


def test_the_command_runs_it(fresh, network, tmp_path):
    command = ["-m", "app.command.cli"]
    words = ["run", network.name, "--output-dir", "out", "--precision", "double"]
    saved = ["--save", "back.image=back.npy", "--save", "scene.image=scene.npy"]
    ran(fresh, *command, *words, *saved, folder=tmp_path)
    back, scene = (np.load(tmp_path / f"{name}.npy") for name in ("back", "scene"))
    assert back.mean() == pytest.approx(0.1 * scene.mean(), rel=1e-12)
    with (tmp_path / "out" / "mtf.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    names = list(rows[0])
    frequency = next(name for name in names if "xi" in name or "frequency" in name)
    column = next(name for name in names if "glare" in name)
    for row in rows:
        if not row[column]:
            continue
        halo = np.exp(-2 * (np.pi * SIGMA * float(row[frequency])) ** 2)
        assert float(row[column]) == pytest.approx(1 - SHARE * (1 - halo), abs=1e-6)
    shown = ran(fresh, *command, "modules", "imagechain_glare.glare_mtf", folder=tmp_path).stdout
    assert "Glare MTF" in shown
    assert "Harvey 1976" in shown


def test_its_battery_runs_where_it_is_installed(fresh, tmp_path):
    script = (
        "from imagechain.battery import check_module\n"
        "import imagechain as ic\n"
        "from nodes.library import standard_library\n"
        "part = ic.modules.imagechain_glare.glare_mtf(scattered_share=0.1)\n"
        "chain = ic.Chain('Glare')\n"
        "scene = ic.modules.test_scene(width=16, height=12)\n"
        "for module in (scene, ic.modules.init_trans(), part, ic.modules.back_transform()):\n"
        "    chain.add(module)\n"
        "assert chain.run().image().shape == (12, 16)\n"
        "for key, module in standard_library().items():\n"
        "    if key.startswith('imagechain_glare.'):\n"
        "        check_module(module)\n"
        "        print(key)\n"
    )
    assert len(ran(fresh, "-c", script, folder=tmp_path).stdout.split()) == 2


def test_without_the_package_a_line_names_it(network, tmp_path):
    done = run_here("check", network, folder=tmp_path)
    assert done.returncode == 2
    assert "imagechain_glare, which is not installed here" in done.stderr + done.stdout
    assert "Traceback" not in done.stderr
    done = run_here("run", network, "--output-dir", "out", folder=tmp_path)
    assert done.returncode == 2
    assert not (tmp_path / "out").exists()


BROKEN = {
    "broken_lens": ("raise ValueError('no lens data')", "ValueError: no lens data"),
    "no_import": ("import no_such_thing", "No module named 'no_such_thing'"),
    "no_module": ("MODULES = [int]", "is not a subclass of Module"),
    "that_ends": ("raise SystemExit(3)", "SystemExit"),
    "takes_ours": (
        "from nodes.library import our_module\nMODULES = [our_module('read_image')]",
        "'read_image', but must be 'takes_ours.read_image'",
    ),
}


def as_installed(folder, name, code):
    """A package of one file of modules, as an installer leaves it."""
    (folder / f"{name}.py").write_text(code, encoding="utf-8")
    about = folder / f"{name}-1.0.dist-info"
    about.mkdir()
    shown = name.replace("_", "-")
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {shown}\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(f"[imagechain.modules]\nlens = {name}:MODULES\n")


def test_broken_packages_keep_nobody_from_working(tmp_path):
    for name, (code, _) in BROKEN.items():
        as_installed(tmp_path, name, code)
    network = {**NETWORK, "nodes": {"lens": {"module": "broken_lens.lens"}}, "links": []}
    (tmp_path / "net.json").write_text(json.dumps(network), encoding="utf-8")
    script = (
        "from app.command.cli import main\n"
        "print(main(['modules', 'gaussian_mtf']), main(['check', 'first_steps']))\n"
        "print(main(['check', 'net.json']))\n"
        "print(main(['modules']))\n"
    )
    path = os.pathsep.join([str(ROOT), str(tmp_path)])
    done = ran(sys.executable, "-c", script, folder=tmp_path, env={"PYTHONPATH": path})
    assert "Gaussian MTF" in done.stdout
    assert "0 0" in done.stdout
    both = done.stdout + done.stderr
    assert "to the package broken_lens, which is installed, but broken_lens:MODULES" in both
    for name, (_, words) in BROKEN.items():
        (line,) = [
            one for one in done.stderr.splitlines() if f"of the package {name} are missing:" in one
        ]
        assert words in line
    assert "Traceback" not in both


FAULTY = '''
from typing import Annotated

import numpy as np

from imagechain.plug_in import (
    Context, Image, ImageOutput, Magnitude, Module, MtfModule, MtfOutputs, NodeContext, Param,
    Step, picture_step, radial, readout, warning,
)


@picture_step()
def step(work, image, *, level):
    return image + {}["step"]


def law(*, rho, level):
    return np.ones_like(rho) * undefined


class Filter(Module, key="faulty_optics.filter", title="Filter", group="Filters"):
    """Fail."""

    where: Annotated[str, Param("where it fails")] = ""

    def check(self):
        if self.where == "check":
            None + 1

    def run(self, image: Image, here: NodeContext) -> ImageOutput:
        if self.where == "run":
            return ImageOutput(1 / 0)
        if self.where == "step":
            made = Step.of(step, image.recipe, node=here.node, level=1.0)
            return ImageOutput(image.with_recipe(made))
        return ImageOutput(image)

    @readout()
    def figure(self) -> float:
        """A figure."""
        return [][1] if self.where == "readout" else 1.0

    @warning
    def looks(self):
        """Look."""
        return [][2] if self.where == "warning" else None


class Lens(MtfModule, key="faulty_optics.lens", title="Lens", group="Optics"):
    """Fail."""

    level: Annotated[float, Param("level", low=0)] = 1.0

    def run(self, context: Context, magnitude: Magnitude, here: NodeContext) -> MtfOutputs:
        factors = radial(law, level=self.level, label=self.title, node=here.node)
        return self.mtf_outputs(magnitude, *factors)


MODULES = (Filter, Lens)
'''
FAULTS = {
    "check": "TypeError: unsupported operand",
    "run": "ZeroDivisionError: division by zero",
    "step": "KeyError: 'step'",
    "readout": "IndexError: list index out of range",
}


def test_a_fault_in_a_plug_in_names_it(tmp_path):
    as_installed(tmp_path, "faulty_optics", FAULTY)
    nodes = {
        "scene": {"module": "test_scene", "params": {"width": 16, "height": 16}},
        "glass": {"module": "faulty_optics.filter"},
        "init": {"module": "init_trans"},
        "back": {"module": "back_transform"},
    }
    links = [["scene.image", "glass.image"], ["glass.image", "init.image"]]
    links += [["init.phase", "back.phase"]]
    whole = {**NETWORK, "nodes": nodes, "links": [*links, ["init.magnitude", "back.magnitude"]]}
    (tmp_path / "net.json").write_text(json.dumps(whole), encoding="utf-8")
    lens = {**nodes, "front lens": {"module": "faulty_optics.lens"}}
    links += [["init.context", "front lens.context"], ["init.magnitude", "front lens.magnitude"]]
    links += [["front lens.magnitude", "back.magnitude"]]
    behind = {**NETWORK, "nodes": lens, "links": links}
    (tmp_path / "lens.json").write_text(json.dumps(behind), encoding="utf-8")
    (tmp_path / "program.py").write_text(
        "import json, sys, traceback\n"
        "from app.command.cli import main\n"
        "from app.editor.evaluation.queries import as_error\n"
        "from app.editor.declared_text import error_text\n"
        "import imagechain as ic\n"
        f"for where in {list(FAULTS)}:\n"
        "    print(main(['run', 'net.json', f'--set=glass.where={where}', '--all']))\n"
        "print(main(['run', 'lens.json']))\n"
        "print(main(['run', 'lens.json', '--debug']), main(['check', 'net.json']))\n"
        "print(main(['run', 'net.json', '--set=glass.where=warning', '--output-dir=out']))\n"
        "chain = ic.open('net.json')\n"
        "chain.set('glass.where', 'step')\n"
        "try:\n"
        "    chain.run().image()\n"
        "except ic.ImagechainError as error:\n"
        "    print(repr(error.__cause__), error.node)\n"
        "    print(traceback.extract_tb(error.__cause__.__traceback__)[-1].line)\n"
        "    print(error_text(as_error(error), on_node=True))\n"
    )
    path = os.pathsep.join([str(ROOT), str(tmp_path)])
    done = ran(sys.executable, "program.py", folder=tmp_path, env={"PYTHONPATH": path})
    lines = FAULTY.splitlines()
    marked = {"check": "None + 1", "run": "1 / 0", "step": '{}["step"]', "readout": "[][1]"}
    told = done.stderr.splitlines()
    for line, (where, words) in zip(told, FAULTS.items(), strict=False):
        number = next(n for n, code in enumerate(lines, 1) if marked[where] in code)
        assert line.startswith(
            "imagechain: glass: a fault in the module faulty_optics.filter of the plug-in "
            f"faulty_optics: {words}"
        )
        assert line.endswith(f"faulty_optics.py, line {number})")
    number = next(n for n, code in enumerate(lines, 1) if "undefined" in code)
    front = (
        "imagechain: front lens: a fault in the module faulty_optics.lens of the plug-in "
        "faulty_optics: NameError: name 'undefined' is not defined"
    )
    assert told[4].startswith(front)
    assert told[4].endswith(f"faulty_optics.py, line {number})")
    assert told[5] == "Traceback (most recent call last):"
    assert told.count(told[4]) == 2  # with --debug, too
    assert "    return np.ones_like(rho) * undefined" in told
    assert "the check 'looks' failed (a fault in the module faulty_optics.filter" in done.stdout
    assert "the error is in the module's package" in done.stdout.lower()
    printed = done.stdout.splitlines()
    assert [line for line in printed if line in ("1", "2", "0")] == ["1", "1", "1", "1", "1", "0"]
    assert "1 0" in printed
    assert printed[-3:-1] == ["KeyError('step') glass", 'return image + {}["step"]']
    assert printed[-1].startswith("a fault in the module faulty_optics.filter of the plug-in")
