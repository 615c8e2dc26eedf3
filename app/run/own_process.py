"""Starting our own modules in processes of their own."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path


def command(module: str, *words: str) -> list[str]:
    """Words that run one of our modules in a new process, wherever that starts."""
    return [sys.executable, "-P", "-m", module, *words]


def environment(variables: Mapping[str, str] | None = None) -> dict[str, str]:
    """Environment of a child as a user would have it, but able to find our packages.

    Parameters
    ----------
    variables : mapping, optional
        What it is to have otherwise; default this process's.
    """
    root = str(Path(__file__).resolve().parents[2])
    known = dict(os.environ if variables is None else variables)
    path = [root, *filter(None, [known.get("PYTHONPATH")])]
    return {**known, "PYTHONPATH": os.pathsep.join(path)}
