"""A signal at any moment gives one line or nothing, and that line is true."""

import os
import signal
import sys

import pytest

from child_process import ROOT, finished

CANCELLED = "imagechain: cancelled; nothing was written\n"
START = """
import os, signal, sys
import app.command.cli, app.command.network_run, app.run.staging

def told(number=signal.SIGTERM):
    os.kill(os.getpid(), number)
    for _ in range(1000):  # Python sees a signal between two steps
        pass

def before(module, name, number=signal.SIGTERM):
    real = getattr(module, name)
    def disturbed(*words, **options):
        told(number)
        return real(*words, **options)
    setattr(module, name, disturbed)

sys.argv = ["imagechain", "run", "net.json"]
"""


@pytest.fixture
def disturbed(tmp_path, write, small):
    """Run the command in a process of its own, with lines before that disturb it."""
    write(small)

    def run(lines):
        program = f"{START}{lines}\nsys.exit(app.command.cli.main())"
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        return finished([sys.executable, "-c", program], folder=tmp_path, env=environment)

    return run


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def test_a_stop_while_an_object_is_deleted(disturbed, tmp_path):
    """Python cannot raise out of a destructor, and prints what it cannot raise."""
    done = disturbed("""
class Disturbing:
    def __del__(self):
        told()

real = app.run.evaluation.evaluate
def evaluate(*words):
    thing = Disturbing()
    del thing
    return real(*words)
app.run.evaluation.evaluate = evaluate
""")
    assert (done.returncode, done.stderr) == (1, CANCELLED)
    assert names(tmp_path) == ["net.json"]


def test_a_second_stop_while_the_first_is_told(disturbed, tmp_path):
    done = disturbed(
        'before(app.run.evaluation, "evaluate"); before(app.command.cli, "print_error")'
    )
    assert (done.returncode, done.stderr) == (1, CANCELLED)
    assert names(tmp_path) == ["net.json"]


def test_a_stop_once_files_appear_comes_too_late(disturbed, tmp_path):
    done = disturbed("before(app.run.staging, '_put')")
    assert (done.returncode, done.stderr) == (0, "")
    assert "net-output: final.png, mtf.csv, readouts.json\n" in done.stdout
    assert names(tmp_path / "net-output") == ["final.png", "mtf.csv", "readouts.json"]


def test_a_stop_while_the_interpreter_ends(disturbed, tmp_path):
    number = signal.SIGINT
    done = disturbed(f"import atexit; atexit.register(told, {int(number)})")
    assert (done.returncode, done.stderr) == (-number, "")
    assert names(tmp_path / "net-output") == ["final.png", "mtf.csv", "readouts.json"]
