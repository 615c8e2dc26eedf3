"""What the handbook holds, in its order."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

PAGES = Path(__file__).with_name("pages")


@dataclass(frozen=True)
class Part:
    """Pages under one title, by the names of their files."""

    title: str
    pages: tuple[str, ...]


PARTS = (
    Part("Begin", ("index", "getting_started")),
    Part(
        "Tutorials",
        (
            "infrared_camera",
            "real_camera",
            "satellite",
            "dirsig_scene",
            "lens_and_mtf",
            "cluster_study",
        ),
    ),
    Part(
        "Guides",
        (
            "editor",
            "commands",
            "network_files",
            "python_package",
            "cameras",
            "judging",
            "studies",
            "beyond_memory",
            "plug_ins",
        ),
    ),
    Part(
        "Reference",
        ("reference", "shipped_networks", "speed_and_accuracy", "how_it_works", "extending"),
    ),
)
REFERENCE = "reference"
"""The page that lists the modules."""
MODULES = "modules"
"""Folder of the modules' pages."""
