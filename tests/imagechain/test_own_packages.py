"""`import imagechain` beside folders and files that have the names of its own packages."""

import re
import sys

import numpy as np
import pytest

from app.run.terminal import environment
from child_process import ROOT, finished

README = (ROOT / "README.md").read_text(encoding="utf-8")
(TEN_LINES,) = re.findall(r"^```python\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)
MORE = """
import numpy
numpy.save("picture.npy", picture)
assert result.curves().to_png()[1:4] == b"PNG"
import matplotlib
assert matplotlib.rcParams["lines.linewidth"] == 7, "the user's settings are lost"
"""


def strangers(folder):
    """A package, a folder of modules, a file and a folder of data, as users have them."""
    for name in ("core", "nodes", "networks"):
        (folder / name).mkdir()
    (folder / "core" / "__init__.py").write_text("raise SystemExit('the user core')\n")
    (folder / "nodes" / "tree.py").write_text("")
    (folder / "app.py").write_text("raise SystemExit('the user app')\n")
    (folder / "networks" / "weights.json").write_text("{}")


def test_the_ten_lines_beside_the_users_own_core(tmp_path):
    """Their picture is the one that the command writes of the saved network, to the bit."""
    folder = tmp_path
    strangers(folder)
    (folder / "matplotlibrc").write_text("lines.linewidth: 7")
    (folder / "mine.py").write_text(TEN_LINES + MORE, encoding="utf-8")
    done = finished([sys.executable, "mine.py"], folder=folder)
    assert done.returncode == 0, done.stderr
    warned = [line for line in done.stderr.splitlines() if "Warning" in line]
    assert len(warned) == 1
    for name in ("core", "nodes", "app.py"):
        assert str(folder / name) in warned[0]
    assert "networks" not in warned[0]
    assert "rename them" in warned[0]
    assert warned[0].startswith(f"{folder / 'mine.py'}:1: UserWarning")
    assert "mtf_at_nyquist_x" in done.stdout
    words = ["run", "mine.json", "--save", "back.image=saved.npy"]
    done = finished([sys.executable, "-m", "imagechain", *words], folder=folder)
    assert (done.returncode, done.stderr) == (0, "")
    picture, saved = np.load(folder / "picture.npy"), np.load(folder / "saved.npy")
    assert picture.dtype == saved.dtype == np.float32
    assert picture.tobytes() == saved.tobytes()


def test_another_core_imported_before_is_refused(tmp_path):
    (tmp_path / "core.py").write_text("")
    done = finished([sys.executable, "-c", "import core, imagechain"], folder=tmp_path)
    assert done.returncode == 1
    last = done.stderr.splitlines()[-1]
    assert last.startswith("ImportError: imagechain cannot be imported: a package with")
    assert f"core from {tmp_path / 'core.py'}" in last


def test_importing_loads_nothing_heavy(tmp_path):
    program = "import sys, imagechain as ic; assert ic.__version__; dir(ic); print(*sys.modules)"
    done = finished([sys.executable, "-c", program], folder=tmp_path)
    assert done.returncode == 0, done.stderr
    names = set(done.stdout.split())
    heavy = {"matplotlib", "PySide6", "dask", "pandas", "xarray", "OpenImageIO", "rich", "scipy"}
    assert not heavy & names
    own = {name for name in names if name.startswith(("core.", "nodes.", "app."))}
    assert own <= {"app.run", "app.run.terminal", "core.errors"}  # which knows the version


IN_PYTHON = (
    "import imagechain as ic; chain = ic.open('first_steps'); chain.set('scene.width', 32); "
    "assert chain.run().image().shape[1] == 32; ic.Chain('new')"
)
GONE = "the current folder has been removed: change to another folder"


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["-c", IN_PYTHON], ""),
        (["-m", "imagechain", "run", "first_steps", "--output-dir", "{}"], ""),
        (["-m", "imagechain", "edit", "--screenshot", "window.png"], GONE),
    ],
)
def test_a_current_folder_that_has_been_removed(words, line, tmp_path):
    words = [word.format(tmp_path / "out") for word in words]
    (tmp_path / "gone").mkdir()
    script = 'cd "$1" && rmdir "$1" && shift && exec "$@"'
    command = ["sh", "-c", script, "sh", tmp_path / "gone", sys.executable, *words]
    # Python itself cannot read a relative name on its path there.
    env = environment() | {"PYTHONPATH": str(ROOT), "QT_QPA_PLATFORM": "offscreen"}
    done = finished([str(word) for word in command], folder=tmp_path, env=env)
    assert done.returncode == (2 if line else 0), done.stderr
    said = done.stderr.replace("No such file or directory (", "").replace(")", "")
    assert said == (f"imagechain: {line}\n" if line else "")
    assert (tmp_path / "out").exists() == ("--output-dir" in words)
