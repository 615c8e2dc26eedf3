"""All files of the handbook, made from one source: Markdown, and the modules' declarations."""

from __future__ import annotations

import hashlib
import html
import json
import shutil
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import Any

from app.handbook.contents import MODULES, PAGES, PARTS, REFERENCE
from app.handbook.example_figures import example_of
from app.handbook.markdown_text import anchor_of, rendered
from app.handbook.module_page import default, module_page, ports, with_symbols
from app.handbook.page_figures import page_figure
from app.user_folders import cache_folder
from core.chain.engine import Engine
from core.errors import FileError
from core.modules.declaration import Declaration, declaration
from core.modules.library_type import Library

TEMPLATES = Path(__file__).with_name("templates")
MARK = "handbook.json"
"""A file that only a handbook's folder has."""


@dataclass(frozen=True)
class Entry:
    """A page in the contents."""

    title: str
    address: str


@dataclass(frozen=True)
class ShownPart:
    """A part of the contents."""

    title: str
    entries: tuple[Entry, ...]


@dataclass(frozen=True)
class Found:
    """A page as the search knows it: address, title, what it is about, all its words."""

    address: str
    title: str
    lead: str
    text: str


def module_address(key: str) -> str:
    """Where a module's page lies, from the handbook's folder."""
    return f"{MODULES}/{key}.html"


def page_titles() -> dict[str, str]:
    """Titles of the pages of Markdown, by their names."""
    return {
        name: _source(name).split("\n", 1)[0].lstrip("# ").strip()
        for part in PARTS
        for name in part.pages
    }


def handbook_files(
    library: Library, progress: Callable[[str], None] = lambda _: None
) -> Iterator[tuple[str, str]]:
    """Every file of the handbook: its name from the handbook's folder, and its content.

    Parameters
    ----------
    library : mapping
        The modules that have pages.
    progress : callable
        Takes the title of the page that is made next.
    """
    declared = [declaration(module) for module in library.values()]
    groups = list(dict.fromkeys(entry.group for entry in declared))
    declared.sort(key=lambda entry: groups.index(entry.group))
    frame = _Frame(declared)
    found = []
    engine = Engine(library)
    for name, title in page_titles().items():
        progress(title)
        addresses = {entry.title: module_address(entry.key) for entry in declared}
        page = rendered(_source(name), addresses, lambda words: page_figure(words, engine))
        body = page.body + (reference(declared) if name == REFERENCE else "")
        address = f"{name}.html"
        yield address, frame.page(address, "page_frame.html", page.title, body=body)
        found.append(Found(address, page.title, _plain(page.lead), _plain(page.words)))
    for entry in declared:
        progress(entry.title)
        shown = module_page(entry, {other.title: f"{other.key}.html" for other in declared})
        address = module_address(entry.key)
        yield (
            address,
            frame.page(
                address,
                "module_page.html",
                entry.title,
                page=shown,
                example=example_of(entry, engine),
                inputs=ports(entry.inputs),
                outputs=", ".join(port.name for port in entry.outputs),
                group_anchor=anchor_of(entry.group),
                parameters=[(p, p.allowed(), default(p)) for p in entry.parameters],
            ),
        )
        found.append(Found(address, entry.title, _plain(entry.summary), _plain(shown.words)))
    rows = [[page.address, page.title, page.lead, page.text] for page in found]
    yield "words.js", f"const WORDS = {json.dumps(rows, ensure_ascii=False)};\n"
    for name in ("handbook.css", "search.js"):
        yield name, (TEMPLATES / name).read_text(encoding="utf-8")


def reference(declared: list[Declaration]) -> str:
    """The list of all modules, by group, as a piece of a page."""
    parts = []
    for group, members in groupby(declared, key=lambda entry: entry.group):
        rows = "".join(
            f'<li><a href="{module_address(entry.key)}">{html.escape(entry.title)}</a>'
            f"<small>{with_symbols(entry.summary, ())}</small></li>"
            for entry in members
        )
        parts.append(
            f'<h2 id="{anchor_of(group)}">{html.escape(group)}</h2>\n'
            f'<ul class="modules">{rows}</ul>\n'
        )
    return "".join(parts)


def cached_handbook(library: Library, progress: Callable[[str], None] = lambda _: None) -> Path:
    """The handbook's folder in the cache; its pages are made if they are not those of today.

    Today's are those of this version, its pages and the modules there are, plug-ins too.

    Raises
    ------
    FileError
        If it cannot be written.
    """
    cache = cache_folder()
    folder = cache / f"handbook-{content_mark(library)}"
    if (folder / MARK).is_file():
        return folder
    try:
        cache.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise FileError(f"cannot make the folder {cache}: {error.strerror or error}") from error
    write_handbook(folder, library, progress)
    for other in cache.glob("handbook-*"):
        if other != folder:
            shutil.rmtree(other, ignore_errors=True)
    return folder


def content_mark(library: Library) -> str:
    """A name that changes with whatever the pages are made of."""
    digest = hashlib.sha256()
    for folder in (PAGES, TEMPLATES):
        for path in sorted(folder.iterdir()):
            if path.is_file():
                digest.update(path.name.encode() + b"\0" + path.read_bytes())
    for module in library.values():
        digest.update(repr(declaration(module)).encode())
    for path in sorted(PAGES.parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def write_handbook(
    folder: Path, library: Library, progress: Callable[[str], None] = lambda _: None
) -> None:
    """Write all pages to a folder: new, empty, or one with a handbook, which is replaced.

    Raises
    ------
    FileError
        If there is something else in the folder, or it cannot be written.
    """
    target = folder.resolve()
    if folder.exists() and not _may_be_replaced(folder):
        raise FileError(
            f"cannot write the handbook to {folder}: it holds something else; name a new folder"
        )
    if not target.parent.is_dir():
        raise FileError(
            f"cannot write the handbook to {folder}: there is no folder {target.parent}"
        )
    replaces, names = (folder / MARK).is_file(), []
    try:
        with tempfile.TemporaryDirectory(
            prefix=".handbook-", dir=target.parent, ignore_cleanup_errors=True
        ) as made:
            pages = Path(made) / "pages"
            for name, content in handbook_files(library, progress):
                file = pages / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_text(content, encoding="utf-8", newline="\n")
                names.append(name)
            facts = {"format": "imagechain-handbook", "version": 1, "files": names}
            (pages / MARK).write_text(json.dumps(facts, indent=1) + "\n", encoding="utf-8")
            if target.exists():
                target.rename(Path(made) / "before")
            pages.rename(target)
    except OSError as error:
        if not replaces and (folder / MARK).is_file():  # another process has just made it
            return
        raise FileError(
            f"cannot write the handbook to {folder}: {error.strerror or error}"
        ) from error


def _may_be_replaced(folder: Path) -> bool:
    return folder.is_dir() and ((folder / MARK).is_file() or not any(folder.iterdir()))


class _Frame:
    """What all pages have: contents, and the pages before and after."""

    def __init__(self, declared: list[Declaration]) -> None:
        from jinja2 import Environment, FileSystemLoader, StrictUndefined

        self._environment = Environment(
            loader=FileSystemLoader(TEMPLATES),
            autoescape=True,
            trim_blocks=True,
            lstrip_blocks=True,
            undefined=StrictUndefined,
        )
        titles = page_titles()
        self._parts = [
            ShownPart(part.title, tuple(Entry(titles[n], f"{n}.html") for n in part.pages))
            for part in PARTS
        ]
        for group, members in groupby(declared, key=lambda entry: entry.group):
            entries = tuple(Entry(entry.title, module_address(entry.key)) for entry in members)
            self._parts.append(ShownPart(f"Modules: {group}", entries))
        self._order = [entry for part in self._parts for entry in part.entries]

    def page(self, address: str, template: str, title: str, **values: Any) -> str:
        place = next(at for at, entry in enumerate(self._order) if entry.address == address)
        return self._environment.get_template(template).render(
            title=title,
            address=address,
            root="../" * address.count("/"),
            parts=self._parts,
            before=self._order[place - 1] if place else None,
            after=self._order[place + 1] if place + 1 < len(self._order) else None,
            **{"body": "", **values},
        )


def _source(name: str) -> str:
    return (PAGES / f"{name}.md").read_text(encoding="utf-8")


def _plain(text: str) -> str:
    """Words without Markdown's signs."""
    return " ".join(text.replace("`", "").replace("*", "").replace("\\", "").split())
