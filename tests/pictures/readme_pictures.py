"""Make the README's pictures of the editor anew: the clip and the still ones.

    python tests/pictures/readme_pictures.py [--into FOLDER] [--only NAME …]

Those of the benchmark belong to one machine and come from `tests/benchmarks/run.py --page`.
"""

import argparse
import os
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SUPPORT = ROOT / "tests" / "support"
sys.path[:0] = [str(ROOT), str(SUPPORT)]

from child_process import finished  # noqa: E402 - a script's own path comes first
from virtual_screen import virtual_screen  # noqa: E402

CLIP = "session.gif"
CLIP_SIZE = 1200, 800
STILLS = {
    "editor.png": ("kodak_kir310",),
    "editor_panel.png": (
        *("inframetrics", "--part", "panel", "--look", "light", "--size", "1100x1800"),
    ),
    "editor_figures.png": ("figures_of_merit", "--size", "1600x1250"),
    "editor_budget.png": ("noise_budget", "--part", "curves"),
}


def make_still(file, words):
    """A part of the window on a network, drawn without a display."""
    command = [sys.executable, "-m", "imagechain", "edit", *words, "--screenshot", str(file)]
    environment = {**os.environ, "QT_QPA_PLATFORM": "offscreen"}
    _succeed(finished(command, env=environment))


def make_clip(file, *rate):
    """The session on a display of its own."""
    script = Path(__file__).with_name("readme_session.py")
    folders = (ROOT, SUPPORT, ROOT / "tests" / "benchmarks", script.parent)
    path = os.pathsep.join(map(str, folders))
    with virtual_screen(*CLIP_SIZE) as environment:
        command = [sys.executable, str(script), str(file), *map(str, rate)]
        _succeed(finished(command, env={**environment, "PYTHONPATH": path}))


def _succeed(done):
    assert done.returncode == 0, done.stderr
    print(done.stdout, end="")


def main():
    """Make those that are asked for."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--into", type=Path, default=ROOT / "networks" / "pictures")
    parser.add_argument("--only", nargs="+", choices=(CLIP, *STILLS), default=(CLIP, *STILLS))
    options = parser.parse_args()
    options.into.mkdir(parents=True, exist_ok=True)
    for name in options.only:
        file = options.into.resolve() / name
        if name == CLIP:
            make_clip(file)
        else:
            make_still(file, STILLS[name])


if __name__ == "__main__":
    main()
