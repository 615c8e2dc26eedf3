"""Importing other programs: quietly, and what prysm asks for that setuptools has no more."""

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
    """Answer prysm 0.21, which asks pkg_resources for its own version and for nothing else.

    Later setuptools, which pyBSM asks for, do not have it.
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
