"""The command line's words; a wrong one is a `UsageError`, never a usage text on stderr."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, NoReturn, cast

from app.options.command_words import (
    bench_words,
    edit_words,
    network_words,
    place_words,
    run_words,
    tradeoff_words,
)
from app.options.option_values import (
    Assignment,
    Save,
    assignment,
    file_path,
    output_path,
    report_path,
    save_target,
    tolerance,
    whole_number,
    window_size,
)
from core.errors import UsageError
from core.evaluation.policy import Precision
from core.modules.parameters import LARGEST_INTEGER
from core.names import close, shown
from nodes.files.formats import PNG

_EPILOG = """\
shipped networks:
{networks}

exit codes:
  0  done
  1  a failure of the program, or stopped
  2  a fault of the input; one line on stderr says which

imagechain COMMAND --help tells the options of a command; --set, --save, --report, --figure and
--output may be repeated, --vary be given twice."""
Look = Literal["dark", "light"]


@dataclass(frozen=True)
class Options:
    """What was asked for."""

    command: Literal["edit", "run", "check", "tradeoff", "modules", "networks", "bench"]
    network: str = ""
    settings: tuple[Assignment, ...] = ()
    final: str | None = None
    saves: tuple[Save, ...] = ()
    output_dir: Path | None = None
    allowed: tuple[Path, ...] = ()
    reports: tuple[Path, ...] = ()
    frames: int | None = None
    vary: tuple[str, ...] = ()
    figures: tuple[str, ...] = ()
    outputs: tuple[Path, ...] = ()
    precision: Precision = "single"
    seed: int | None = None
    tolerance: float | None = None
    threads: int = 0
    as_json: bool = False
    module: str = ""
    bench_json: Path | None = None
    bench_html: Path | None = None
    bench_markdown: Path | None = None
    bench_pictures: Path | None = None
    quick: bool = False
    parts: tuple[str, ...] = ()
    size: int | None = None
    screenshot: Path | None = None
    window_size: tuple[int, int] | None = None
    look: Look | None = None
    part: str = "window"


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message} ({self.prog} --help)")

    def option_names(self) -> list[str]:
        """Each option, in every way it may be written."""
        return list(self._option_string_actions)

    def refuse(self, word: str) -> NoReturn:
        """Say that there is no such option, or no room for another word."""
        name = word.partition("=")[0]
        if not name.startswith("-"):
            self.error(f"{shown(name)} is one word too many")
        self.error(f"there is no option {shown(name)}{close(name, self.option_names())}")

    def print_help(self, file: Any = None) -> None:
        # argparse's own says nothing where the disk is full.
        print(self.format_help(), end="", file=file, flush=True)


class _Version(argparse.Action):
    # Asked of the installation only when wanted: that costs a run 20 ms.
    def __call__(self, parser: argparse.ArgumentParser, *_: Any, **__: Any) -> None:
        print(f"imagechain {version()}")
        parser.exit()


def parse(argv: list[str]) -> Options:
    """Read the command line.

    Raises
    ------
    UsageError
        If it cannot be carried out.
    SystemExit
        After printing the help or version asked for.
    """
    found = _found(argv)
    if found.command == "networks":
        return Options("networks")
    if found.command == "modules":
        return Options("modules", as_json=found.json, module=found.key or "")
    if found.command == "bench":
        return Options(
            "bench",
            bench_json=file_path("--json", found.json),
            bench_html=file_path("--html", found.html),
            bench_markdown=file_path("--markdown", found.markdown),
            bench_pictures=file_path("--pictures", found.pictures),
            quick=found.quick,
            parts=tuple(found.only),
            size=whole_number("--size", found.size),
        )
    if found.command == "edit":
        shot = file_path("--screenshot", found.screenshot)
        if shot is not None and not PNG.matches(shot):
            raise UsageError(f"--screenshot {found.screenshot}: a name that ends in .png")
        return Options(
            "edit",
            found.network or "",
            screenshot=shot,
            window_size=window_size("--size", found.size),
            look=cast("Look | None", found.look),
            part=found.part,
        )
    settings = tuple(assignment("--set", text, "NODE.PARAM=VALUE") for text in found.set)
    if found.command == "check":
        return Options("check", found.network, settings, final=found.final, **_places(found))
    common: dict[str, Any] = {
        "settings": settings,
        "final": found.final,
        "precision": found.precision,
        "tolerance": tolerance(found.tolerance),
        "seed": whole_number("--seed", found.seed, largest=LARGEST_INTEGER),
        "threads": whole_number("--threads", found.threads, largest=1024) or 0,
    }
    if found.command == "tradeoff":
        return Options(
            "tradeoff",
            found.network,
            vary=tuple(found.vary),
            figures=tuple(found.figure),
            outputs=tuple(output_path(text) for text in found.output),
            **common,
        )
    return Options(
        "run",
        found.network,
        saves=tuple(save_target(text) for text in found.save),
        reports=tuple(report_path(text) for text in found.report),
        frames=whole_number("--frames", found.frames),
        **_places(found),
        **common,
    )


def _places(found: argparse.Namespace) -> dict[str, Any]:
    """Where a run writes, and where its network may."""
    allowed = (file_path("--allow-writes-to", text) for text in found.allow_writes_to)
    return {
        "output_dir": file_path("--output-dir", found.output_dir),
        "allowed": tuple(folder for folder in allowed if folder is not None),
    }


def _found(argv: list[str]) -> argparse.Namespace:
    """The words as argparse reads them; one it does not know is told with what is like it."""
    first = argv[0]
    parser, commands = _parser(first)
    if not first.startswith("-") and first not in commands:
        hint = close(first, commands) or f"; there are {', '.join(commands)}"
        parser.error(f"there is no command {shown(first)}{hint}")
    used = commands.get(first, parser)
    if used is parser and first not in parser.option_names():
        parser.refuse(first)
    found, unknown = parser.parse_known_args(argv)
    if unknown:
        used.refuse(unknown[0])
    return found


def _shipped() -> str:
    from app.run.shipped import shipped_networks

    return textwrap.fill(
        ", ".join(shipped_networks()) or "none",
        76,
        initial_indent="  ",
        subsequent_indent="  ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def _parser(used: str) -> tuple[_Parser, Mapping[str, _Parser]]:
    """The parser of all commands, and that of each; only the used one knows its words."""
    parser = _Parser(
        prog="imagechain",
        description="Simulate electro-optical and infrared image chains.",
        epilog=_EPILOG.format(networks=_shipped()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, (about, words) in _COMMANDS.items():
        command = commands.add_parser(name, help=about, allow_abbrev=False)
        if name == used:  # the words of them all take longer to build than to read
            words(command)
    return parser, commands.choices


def _check_words(parser: argparse.ArgumentParser) -> None:
    network_words(parser)
    place_words(parser)


def _modules_words(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("key", metavar="KEY", nargs="?", help="only this module")
    parser.add_argument("--json", action="store_true", help="for programs")


_COMMANDS: Mapping[str, tuple[str, Callable[[argparse.ArgumentParser], object]]] = MappingProxyType(
    {
        "edit": ("open the editor", edit_words),
        "run": ("evaluate a network", run_words),
        "check": ("validate a network", _check_words),
        "tradeoff": ("figures of merit as a parameter moves", tradeoff_words),
        "networks": ("list the shipped networks", lambda _: None),
        "modules": ("list the library", _modules_words),
        "bench": ("time against error", bench_words),
    }
)


def version() -> str:
    """The installed version of this program."""
    from importlib import metadata

    try:
        return metadata.version("imagechain")
    except metadata.PackageNotFoundError:
        return "(source tree)"
