"""``imagechain edit``: open the editor, or draw its window to a file, if Qt can run here."""

from __future__ import annotations

import os
import socket
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from app.command import options
from app.run import option_values as values
from app.run.shipped import find_network
from app.run.terminal import Stop
from core.errors import UsageError
from nodes.files.file_format import PNG

if TYPE_CHECKING:
    from app.editor.theme import Look

OFFSCREEN = "offscreen"
_PARTS = ("window", "canvas", "panel", "curves", "picture")  # of the window
_X_SOCKETS = Path("/tmp/.X11-unix")


@options.command()
@options.argument(
    "network", "[NETWORK]", "a network file, or the name of an example network", required=False,
)  # fmt: skip
@options.option(
    "--screenshot", "FILE", "save the window as .png and exit; needs no display",
    values.ending_in(PNG))  # fmt: skip
@options.option(
    "--part", f"[{'|'.join(_PARTS)}]",
    "what to save: window (default), canvas, panel, curves or picture (of the first viewer, "
    "scaled down if larger than --size)",
    options.one_of(*_PARTS), default="window")  # fmt: skip
@options.option(
    "--size", "WxH",
    "size of the window (default: the last size; at the first start, a size that fits the "
    "screen; for a screenshot, 1600x900)", values.window_size)  # fmt: skip
@options.option(
    "--look", "[dark|light]", "colour theme (default: the last one used)",
    options.one_of("dark", "light"),
)  # fmt: skip
def edit(
    stop: Stop,
    network: str,
    screenshot: Path | None,
    part: str,
    size: tuple[int, int] | None,
    look: Look | None,
) -> None:
    """Open the editor, or save a screenshot of it."""
    if network:
        find_network(network)  # a misspelt name is told before what takes long to load
    from app.editor import qt_libraries as qt

    if screenshot is not None:
        os.environ.setdefault("QT_QPA_PLATFORM", OFFSCREEN)
    elif sys.platform.startswith("linux"):
        check_display(os.environ)
    platform = os.environ.get("QT_QPA_PLATFORM", "").partition(":")[0]
    qt.check_libraries(window=platform in ("", "xcb"))
    try:
        import PySide6.QtWidgets  # noqa: F401
    except ImportError as error:
        raise UsageError(f"the editor needs Qt, which cannot be loaded: {error}") from error
    qt.leave_sources_unread()
    with qt.nothing_collected(), qt.names_looked_up():
        from app.editor.window.start import start

    start(stop, network, look=look, size=size, screenshot=screenshot, part=part)


def check_display(environment: os._Environ[str] | dict[str, str]) -> None:
    """Refuse to start without a display: Qt itself would end the process with a core dump."""
    platform = environment.get("QT_QPA_PLATFORM", "").partition(":")[0]
    if platform and platform not in ("xcb", "wayland"):
        return
    if platform != "xcb" and environment.get("WAYLAND_DISPLAY"):
        return
    display = environment.get("DISPLAY", "")
    if not display:
        raise UsageError(
            "the editor needs a display: DISPLAY and WAYLAND_DISPLAY are empty (imagechain "
            "run needs no display)"
        )
    if not _answers(display):
        raise UsageError(f"the editor needs a display: no response from DISPLAY = {display:.80}")


def _answers(display: str) -> bool:
    host, _, number = display.rpartition(":")
    try:
        screen = int(number.partition(".")[0])
        if host not in ("", "unix"):
            return _connects(socket.AF_INET, (host, 6000 + screen))
        path = str(_X_SOCKETS / f"X{screen}")
        # Some servers listen on the abstract name alone.
        return any(_connects(socket.AF_UNIX, prefix + path) for prefix in ("", "\0"))
    except (OSError, OverflowError, ValueError):
        return False


def _connects(family: socket.AddressFamily, address: Any) -> bool:
    with socket.socket(family, socket.SOCK_STREAM) as trial:
        trial.settimeout(3)
        return trial.connect_ex(address) == 0
