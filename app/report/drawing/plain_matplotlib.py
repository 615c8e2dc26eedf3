"""Matplotlib without the user's settings, and without messages on standard error."""

from __future__ import annotations

import contextlib
import logging
import os
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any


def load_matplotlib() -> Any:
    """Import matplotlib as it was made: pictures are the same for every user and folder.

    Where the user's cache folder cannot be written, it makes a temporary one itself and removes it.
    """
    if "matplotlib" not in sys.modules:
        logging.getLogger("matplotlib").setLevel(logging.CRITICAL + 1)
        own = _own_settings()
        with _environment(MPLBACKEND="Agg", MATPLOTLIBRC=str(own)), _within(own.parent):
            import matplotlib.backends.backend_agg
            import matplotlib.figure
    import matplotlib as mpl

    return mpl


def _own_settings() -> Path:
    spec = find_spec("matplotlib")
    assert spec is not None
    assert spec.submodule_search_locations is not None
    return Path(spec.submodule_search_locations[0]) / "mpl-data" / "matplotlibrc"


@contextlib.contextmanager
def _environment(**variables: str) -> Iterator[None]:
    before = {name: os.environ.get(name) for name in variables}
    os.environ.update(variables)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _within(folder: Path) -> Iterator[None]:
    """Go to a folder: a matplotlibrc in the current one goes before any other."""
    if not Path("matplotlibrc").exists():
        yield
        return
    with contextlib.chdir(folder):
        yield
