"""``imagechain handbook``: the pages in the browser, or in a folder."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from app.options.command_options import Options
from app.options.stopping import Stop
from app.options.terminal_streams import show
from core.errors import UsageError
from core.names import close, shown
from nodes.library import standard_library


def carry_out(options: Options, stop: Stop) -> None:
    """Open the handbook at its first page, or at that of a word; or write it to a folder."""
    from app.handbook.written_pages import cached_handbook, write_handbook

    if options.html is not None and options.path:
        raise UsageError("--html DIR and --path exclude each other: --html prints its path")
    library = standard_library()
    address = page_of(options.word) if options.word else "index.html"
    with _Titles(stop) as progress:
        if options.html is not None:
            write_handbook(options.html, library, progress)
            folder = options.html
        else:
            folder = cached_handbook(library, progress)
    page = folder.resolve() / address
    show(options, lambda: {"page": str(page)}, str(page))
    if options.html is None and not options.path:
        open_page(page)


def page_of(word: str) -> str:
    """The page that a word names: a module's key or title, a page's name or title, or its words."""
    from app.handbook.page_finding import find_page

    library = standard_library()
    address, known = find_page(word, library)
    if address is None:
        hint = close(word, known) or "; imagechain handbook opens the first page"
        raise UsageError(f"the handbook has no page on {shown(word)}{hint}")
    return address


def open_page(page: Path) -> bool:
    """Show a page in the browser; False where there is none, or no display for it."""
    import webbrowser

    displays = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
    if sys.platform not in ("win32", "darwin") and not any(os.environ.get(d) for d in displays):
        return False
    try:
        return webbrowser.open(page.as_uri())
    except (OSError, webbrowser.Error):
        return False


class _Titles:
    """Shows which page is made, on a terminal; and stops where the command is to stop."""

    def __init__(self, stop: Stop) -> None:
        from app.options.progress import Progress

        self._progress = Progress(_page_count())
        self._stop = stop

    def __enter__(self) -> _Titles:
        self._progress.__enter__()
        return self

    def __exit__(self, *about: object) -> None:
        self._progress.__exit__(None, None, None)

    def __call__(self, title: str) -> None:
        from app.options.stopping import Stopped

        if self._stop.is_set():
            raise Stopped
        self._progress(title)


def _page_count() -> int:
    from app.handbook.module_examples import PARTS

    return sum(len(part.pages) for part in PARTS) + len(standard_library())
