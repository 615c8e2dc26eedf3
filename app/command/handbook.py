"""``imagechain handbook``: the pages in the browser, or in a folder."""

from __future__ import annotations

import os
import sys
import webbrowser
from pathlib import Path

from app.command.results import Progress, show
from app.handbook.module_examples import PARTS
from app.handbook.written_pages import cached_handbook, find_page, readable_handbook, write_handbook
from app.options.command_options import Options
from app.options.stopping import Stop, Stopped
from core.errors import UsageError
from core.names import close, shown
from nodes.library import standard_library


def carry_out(options: Options, stop: Stop) -> None:
    if options.html is not None and options.path:
        raise UsageError("--html DIR and --path cannot be used together: --html prints its path")
    library = standard_library()
    address: str | None = "index.html"
    if options.word:
        address, known = find_page(options.word, library)
        if address is None:
            hint = close(options.word, known) or "; imagechain handbook opens the first page"
            raise UsageError(f"the handbook has no page on {shown(options.word)}{hint}")
    pages = sum(len(part.pages) for part in PARTS) + len(library)
    with Progress(pages) as progress:

        def made_next(title: str) -> None:
            if stop.is_set():
                raise Stopped
            progress(title)

        opened = options.html is None and not options.path
        if options.html is not None:
            write_handbook(options.html, library, made_next)
            folder = options.html
        elif opened:
            folder = readable_handbook(library)
        else:
            folder = cached_handbook(library, made_next)
        page = folder.resolve() / str(address)
        show(options, lambda: {"page": str(page)}, str(page))
        if opened:
            open_page(page)
            cached_handbook(library, made_next)


def open_page(page: Path) -> bool:
    """Show a page in the browser; False where there is none, or no display for it."""
    displays = ("DISPLAY", "WAYLAND_DISPLAY", "BROWSER")
    if sys.platform not in ("win32", "darwin") and not any(os.environ.get(d) for d in displays):
        return False
    try:
        return webbrowser.open(page.as_uri())
    except (OSError, webbrowser.Error):
        return False
