"""Importing other programs: quietly, and prysm with the version lookup that setuptools lacks."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module, metadata
from importlib.util import find_spec
from types import ModuleType
from typing import Any

GONE = "pkg_resources"


def load(name: str) -> Any:
    """A module of another program; its warnings are none of ours.

    Raises
    ------
    ImportError
        If it is not installed or does not import.
    """
    with warnings.catch_warnings(), _version_lookup():
        warnings.simplefilter("ignore")
        return import_module(name)


def why_missing(package: str) -> str:
    """Why a program cannot be measured; empty if it can."""
    try:
        load(package)
    except ImportError as error:
        return "not installed" if error.name == package else f"not importable: {error}"[:120]
    return ""


@contextmanager
def _version_lookup() -> Iterator[None]:
    """Stand in for pkg_resources, from which prysm 0.21 takes its version and nothing else.

    Later setuptools, which pyBSM requires, do not have it.
    """
    if GONE in sys.modules or find_spec(GONE) is not None:
        yield
        return
    answer = ModuleType(GONE)
    answer.get_distribution = metadata.distribution  # type: ignore[attr-defined]
    sys.modules[GONE] = answer
    try:
        yield
    finally:
        del sys.modules[GONE]
