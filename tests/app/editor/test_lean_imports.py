"""What is imported for the window, and how."""

import subprocess
import sys

from app.run.terminal import environment


def answers_of(code: str) -> list[str]:
    """Lines printed in a process of its own."""
    run = [sys.executable, "-P", "-c", code]
    done = subprocess.run(run, env=environment(), capture_output=True, text=True, check=True)
    return done.stdout.split()


def test_the_bindings_keep_no_source_of_what_is_imported_after_them():
    """Python keeps the lines of each file that was read as a source."""
    code = (
        "import PySide6.QtWidgets, linecache, sys\n"
        "from app.editor.qt_libraries import leave_sources_unread\n"
        "leave_sources_unread()\n"
        "import core.chain.engine\n"
        "print(sys.modules['core.chain.wires'].__file__ in linecache.cache)\n"
    )
    assert answers_of(code) == ["False"]


def test_pyqtgraph_has_qt_make_only_the_classes_that_it_uses():
    code = (
        "import PySide6.QtGui as bindings\n"
        "from app.editor.qt_libraries import names_looked_up\n"
        "with names_looked_up():\n"
        "    from pyqtgraph.Qt import QtGui as mirror\n"
        "print(len(vars(mirror)) < 100, mirror.QPdfWriter is bindings.QPdfWriter)\n"
        "print('QPdfWriter' in dir(bindings))\n"
    )
    assert answers_of(code) == ["True", "True", "True"]


def test_the_canvas_imports_no_more_than_the_view_layer():
    code = (
        "import app.editor.canvas.nodegraphqt as taken, sys\n"
        "names = ('distutils', 'setuptools', 'Qt', 'NodeGraphQt.base.graph')\n"
        "print(*(name for name in names if name in sys.modules))\n"
        "menu = sys.modules['NodeGraphQt.base.menu']\n"
        "print(menu.LooseVersion('6.11.3') >= menu.LooseVersion('5.10'))\n"
        "print(menu.LooseVersion('5.9') >= menu.LooseVersion('5.10'))\n"
    )
    assert answers_of(code) == ["True", "False"]


def test_nothing_is_collected_while_the_window_is_made():
    """Neither then nor later: what was made is passed over by each collection that follows."""
    code = (
        "import gc\n"
        "from app.editor.qt_libraries import nothing_collected\n"
        "usual, passed = gc.get_threshold(), []\n"
        "gc.callbacks.append(lambda phase, about: passed.append(phase))\n"
        "with nothing_collected():\n"
        "    made = [[] for _ in range(50 * usual[0])]\n"
        "print(len(passed), gc.get_threshold() == usual, gc.isenabled())\n"
        "print(gc.get_freeze_count() > len(made), any(each is made for each in gc.get_objects()))\n"
        "made = [[] for _ in range(50 * usual[0])]\n"
        "print(len(passed) > 0)\n"
    )
    assert answers_of(code) == ["0", "True", "True", "True", "False", "True"]
