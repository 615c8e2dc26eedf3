"""`pytest -m quick` reads the files it runs, and no others."""

import sys

from child_process import finished
from quick_tests import is_quick, named


def test_the_files_that_are_named_are_there():
    assert [path for path in named() if not path.is_file()] == []


def test_only_quick_files_are_read():
    words = ["-m", "pytest", "--collect-only", "-q", "-n", "0", "-p", "no:cacheprovider"]
    done = finished([sys.executable, *words, "-m", "quick", "tests/test_layers.py", "tests/nodes"])
    assert done.returncode == 0, done.stdout
    files = {line.partition("::")[0] for line in done.stdout.splitlines() if "::" in line}
    assert files == {"tests/test_layers.py", "tests/nodes/test_library_declarations.py"}
    assert "deselected" not in done.stdout
    assert not is_quick(next(path for path in named() if "slanted" in path.name))
