"""The command line's words; a wrong one is a `UsageError`, never a usage text on stderr."""

from __future__ import annotations

import argparse
import textwrap
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, NoReturn, cast

from app.option_values import (
    SAVE_SUFFIXES,
    Assignment,
    Save,
    assignment,
    file_path,
    report_path,
    save_target,
    tolerance,
    whole_number,
    window_size,
)
from core.errors import UsageError
from core.parameters import LARGEST_INTEGER
from core.policy import Precision

_EPILOG = """\
shipped networks:
{networks}

exit codes:
  0  done
  1  a failure of the program, or stopped
  2  a fault of the input; one line on stderr says which

imagechain COMMAND --help tells the options of a command; --set, --save and --report may be
repeated."""
BENCH_PARTS = ("speed", "precision", "peers", "editor")
SCREENSHOT_PARTS = ("window", "canvas", "panel", "curves", "picture")
Look = Literal["dark", "light"]


@dataclass(frozen=True)
class Options:
    """What was asked for."""

    command: Literal["edit", "run", "check", "modules", "bench"]
    network: str = ""
    settings: tuple[Assignment, ...] = ()
    saves: tuple[Save, ...] = ()
    output_dir: Path | None = None
    reports: tuple[Path, ...] = ()
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
        raise UsageError(f"{message} (imagechain --help)")

    def print_help(self, file: Any = None) -> None:
        # argparse's own says nothing where the disk is full.
        print(self.format_help(), end="", file=file, flush=True)


class _Version(argparse.Action):
    # Asked of the installation only when wanted: that costs a run 20 ms.
    def __call__(self, parser: argparse.ArgumentParser, *_: Any, **__: Any) -> None:
        print(f"imagechain {version()}")
        parser.exit()


class _Once(argparse.Action):
    # Kept on the namespace, not here: a parser may be used again.
    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: Any,
        option_string: str | None = None,
    ) -> None:
        given: set[str] = namespace.__dict__.setdefault("given", set())
        if self.dest in given:
            parser.error(f"{option_string} is given more than once")
        given.add(self.dest)
        setattr(namespace, self.dest, values)


def parse(argv: list[str]) -> Options:
    """Read the command line.

    Raises
    ------
    UsageError
        If it cannot be carried out.
    SystemExit
        After printing the help or version asked for.
    """
    found = _parser().parse_args(argv)
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
        if shot is not None and shot.suffix.lower() != ".png":
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
        return Options("check", found.network, settings)
    return Options(
        "run",
        found.network,
        settings,
        saves=tuple(save_target(text) for text in found.save),
        output_dir=file_path("--output-dir", found.output_dir),
        reports=tuple(report_path(text) for text in found.report),
        precision=cast(Precision, found.precision),
        tolerance=tolerance(found.tolerance),
        seed=whole_number("--seed", found.seed, largest=LARGEST_INTEGER),
        threads=whole_number("--threads", found.threads, largest=1024) or 0,
    )


def _shipped() -> str:
    from app.shipped import shipped_networks

    return textwrap.fill(
        ", ".join(shipped_networks()) or "none",
        76,
        initial_indent="  ",
        subsequent_indent="  ",
        break_long_words=False,
        break_on_hyphens=False,
    )


def _parser() -> argparse.ArgumentParser:
    parser = _Parser(
        prog="imagechain",
        description="Simulate electro-optical and infrared image chains.",
        epilog=_EPILOG.format(networks=_shipped()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    _edit_words(commands.add_parser("edit", help="open the editor", allow_abbrev=False))
    _run_words(commands.add_parser("run", help="evaluate a network", allow_abbrev=False))
    check = commands.add_parser("check", help="validate a network", allow_abbrev=False)
    _network_words(check)
    modules = commands.add_parser("modules", help="list the library", allow_abbrev=False)
    modules.add_argument("key", metavar="KEY", nargs="?", help="only this module")
    modules.add_argument("--json", action="store_true", help="for programs")
    _bench_words(commands.add_parser("bench", help="time against error", allow_abbrev=False))
    return parser


def _network_words(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("network", metavar="NETWORK", help="a file, or the name of a shipped one")
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NODE.PARAM=VALUE",
        help="change a parameter for this once; null empties it; may be repeated",
    )


def _edit_words(parser: argparse.ArgumentParser) -> None:
    add: Any = parser.add_argument
    add("network", metavar="NETWORK", nargs="?", help="a file, or the name of a shipped one")
    add(
        "--screenshot",
        action=_Once,
        metavar="FILE",
        help="draw the window, without a display, to a .png and end",
    )
    add(
        "--part",
        action=_Once,
        choices=SCREENSHOT_PARTS,
        default="window",
        help="window (default), canvas, panel, curves, or the first viewer's picture within --size",
    )
    add("--size", action=_Once, metavar="WxH", help="of the window (default: 1600x900)")
    add("--look", action=_Once, choices=("dark", "light"), help="colours (default: as last time)")


def _run_words(parser: argparse.ArgumentParser) -> None:
    _network_words(parser)
    add: Any = parser.add_argument
    add(
        "--save",
        action="append",
        default=[],
        metavar="NODE.PORT=FILE",
        help=f"write what a port gives, as {' '.join(SAVE_SUFFIXES)}; NODE.PORT[TOP:BOTTOM,"
        "LEFT:RIGHT]=FILE writes those rows and columns of an image, counted from 0, the ends "
        "exclusive, a bound left out being the image's; may be repeated",
    )
    add(
        "--output-dir",
        action=_Once,
        metavar="DIR",
        help="where final.png, mtf.csv and readouts.json go (default ./NAME-output)",
    )
    add(
        "--report",
        action="append",
        default=[],
        metavar="FILE",
        help="write a report, .html or .json; may be repeated",
    )
    add(
        "--precision",
        action=_Once,
        choices=("single", "double"),
        default="single",
        help="default: single",
    )
    add(
        "--tolerance",
        action=_Once,
        metavar="T",
        help="error budget: leave out stages that together change the picture by less than this "
        "fraction of its range, 0 to below 1 (default: below the precision's rounding; 0: only "
        "what changes nothing at all)",
    )
    add("--seed", action=_Once, metavar="N", help="of the noise, in place of the network's")
    add("--threads", action=_Once, metavar="N", help="worker threads (default: all)")


def _bench_words(parser: argparse.ArgumentParser) -> None:
    add: Any = parser.add_argument
    add("--json", metavar="FILE", help="write every figure, for programs")
    add("--html", metavar="FILE", help="write a page with tables and pictures")
    add(
        "--markdown",
        metavar="FILE",
        help="write the tables of speed and peers, in a file that is there between its lines "
        "<!-- bench table --> and <!-- end of bench table -->",
    )
    add("--pictures", metavar="DIR", help="write each picture as bench_NAME.png")
    add("--quick", action="store_true", help="fewer repetitions and sizes")
    add(
        "--only",
        action="append",
        default=[],
        choices=BENCH_PARTS,
        metavar="PART",
        help="measure this part: " + ", ".join(BENCH_PARTS),
    )
    add("--size", metavar="N", help="samples along a side of the picture (default: 1024)")


def version() -> str:
    """The installed version of this program."""
    from importlib import metadata

    try:
        return metadata.version("imagechain")
    except metadata.PackageNotFoundError:
        return "(source tree)"
