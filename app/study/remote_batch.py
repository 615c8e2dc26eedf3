"""What a worker of a cluster is sent: a function that finds this program where it is installed."""

from __future__ import annotations

import types
from collections.abc import Callable
from typing import Any


def sent_by_value(function: Callable[..., Any]) -> Callable[..., Any]:
    """The function as one that is pickled with its code, as those of a user's own script are.

    A worker that was started beside a folder named `core` or `app` finds that in the place of
    ours: code that is sent can look in other places first, a reference to a module cannot.
    """
    copy = types.FunctionType(function.__code__, {"__builtins__": __builtins__}, function.__name__)
    copy.__module__ = "__main__"
    return copy


def rows_there(setting: bytes, key: str, tasks: Any, share: int) -> Any:
    """The rows of a batch, on a worker; what it imports is all it knows there."""
    import importlib
    import os
    import sys

    # Python and the worker's own start look in the current folder first.
    here = {"", os.getcwd()}  # noqa: PTH109
    path = list(sys.path)
    try:
        if "app.study.worker_rows" not in sys.modules:
            sys.path[:] = [entry for entry in path if entry not in here]
            for name in ("core", "nodes", "app", "networks"):
                try:
                    importlib.import_module(name)
                except ModuleNotFoundError:  # it runs from a source tree, and is not installed
                    sys.path[:] = path
        from app.study.worker_rows import rows_of_batch
    finally:
        sys.path[:] = path
    return rows_of_batch(setting, key, tasks, share)
