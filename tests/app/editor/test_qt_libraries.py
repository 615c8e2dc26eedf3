"""What Qt needs of the system is looked for in full before Qt is loaded."""

import pytest

from app.bench.timing import STEADY
from app.editor import qt_libraries
from app.editor.qt_libraries import DRAWING, WINDOW, check_libraries
from child_process import ROOT
from core.errors import UsageError

LACKED = ["libEGL.so.1", "libglib-2.0.so.0"]


@pytest.fixture
def broken(tmp_path):
    """An environment in which some libraries are files that are none; no display is needed."""
    folder = tmp_path / "lib"
    folder.mkdir()
    for name in (*LACKED, "libxcb-cursor.so.0"):
        (folder / name).write_text("no library")
    return {"LD_LIBRARY_PATH": str(folder), "QT_QPA_PLATFORM": "offscreen"}


TOLD = (
    "imagechain: the editor needs system libraries that are missing: libEGL.so.1, "
    "libglib-2.0.so.0 (on Debian or Ubuntu, as root: apt-get install -y libegl1 libglib2.0-0)\n"
)


def test_all_that_is_missing_is_told_in_one_line(broken, imagechain_process, tmp_path):
    words = ("edit", "first_steps", "--screenshot", "w.png")
    done = imagechain_process(*words, env={**broken, **STEADY})
    assert (done.returncode, done.stderr) == (2, TOLD)
    assert not (tmp_path / "w.png").exists()


def test_a_window_needs_more_than_a_picture(monkeypatch):
    check_libraries(window=True)  # this machine has them all
    monkeypatch.setattr(qt_libraries, "WINDOW", WINDOW | {"libnowhere.so.7": "libnowhere7"})
    check_libraries(window=False)
    with pytest.raises(UsageError, match=r"libnowhere\.so\.7 .*apt-get install -y libnowhere7\)"):
        check_libraries(window=True)


def test_the_readme_brings_them_all():
    """Those that others bring along are not named there."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    named = text.partition("<!-- system packages -->")[2].partition("```\n\n")[0]
    brought = {"libx11-6", "libx11-xcb1"}  # by libgl1
    brought |= {"libxcb-image0", "libxcb-render-util0"}  # by libxcb-cursor0
    brought |= {"libxcb-randr0", "libxcb-sync1", "libxcb-xfixes0"}  # by libegl1
    assert {*DRAWING.values(), *WINDOW.values()} - brought <= set(named.split())
