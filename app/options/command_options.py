"""The command line as options; a wrong word is a `UsageError`, never a usage text on stderr."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NoReturn

from app.options.command_words import COMMANDS, SAVED, Word
from app.options.option_values import Assignment, Save
from core.errors import UsageError
from core.names import close, shown
from nodes.files.common.file_format import suffixes

if TYPE_CHECKING:
    from core.evaluation.policy import Precision

_EPILOG = """example networks:
{networks}

exit codes:
  0  done
  1  the program failed or was stopped
  2  the input has an error; one line on stderr says which

imagechain help COMMAND lists the options of a command. --set, --save, --report, --figure and
--output may be repeated; --vary may be given twice, and any number of times for a study."""


class Options(argparse.Namespace):
    """What the command line gives; what it leaves out is as here."""

    command: str = ""
    json: Literal[True] | Path | None = None
    # A network, and how it is evaluated.
    network: str = ""
    settings: tuple[Assignment, ...] = ()
    disabled: tuple[str, ...] = ()
    final: str | None = None
    scenes: tuple[str, ...] = ()
    scene_unit: str | None = None
    scene_fov_deg: tuple[float, float] | None = None
    scene_band_um: tuple[float, float] | None = None
    scene_range_m: float | None = None
    scene_sample_m: float | None = None
    precision: Precision = "single"
    tolerance: float | None = None
    seed: int | None = None
    threads: int = 0
    memory_bytes: int | None = None
    # What is computed and written.
    saves: tuple[Save, ...] = ()
    frames: int | None = None
    output_dir: Path | None = None
    allowed: tuple[Path, ...] = ()
    all: bool = False
    scratch: Path | None = None
    reports: tuple[Path, ...] = ()
    vary: tuple[str, ...] = ()
    figures: tuple[str, ...] = ()
    outputs: tuple[Path, ...] = ()
    # A study, and what is sought or fitted.
    over: tuple[str, ...] = ()
    sample: str = "grid"
    points: int | None = None
    jobs: int | None = None
    scheduler: str = ""
    tls_ca_file: str | None = None
    tls_cert: str | None = None
    tls_key: str | None = None
    output: Path | None = None
    summaries: tuple[Path, ...] = ()
    fresh: bool = False
    solve_for: str = ""
    until: str = ""
    free: tuple[str, ...] = ()
    known_scene: bool = False
    # Pictures that are measured.
    pictures: tuple[Path, ...] = ()
    band: int | None = None
    csv: Path | None = None
    report: Path | None = None
    fov_x_deg: float | None = None
    pitch_um: float | None = None
    flats: tuple[Path, ...] = ()
    dark: Path | None = None
    offset_dn: float | None = None
    fields: tuple[tuple[Path, float], ...] = ()
    # Everything else.
    key: str = ""
    word: str = ""
    html: Path | None = None
    path: bool = False
    quick: bool = False
    only: tuple[str, ...] = ()
    size: int | None = None
    screenshot: Path | None = None
    window_size: tuple[int, int] | None = None
    look: Literal["dark", "light"] | None = None
    part: str = "window"

    @property
    def json_file(self) -> Path | None:
        return self.json if isinstance(self.json, Path) else None


class _Parser(argparse.ArgumentParser):
    def error(self, message: str) -> NoReturn:
        raise UsageError(f"{message} ({self.prog} --help)")

    def option_names(self) -> list[str]:
        return list(self._option_string_actions)

    def refuse(self, word: str) -> NoReturn:
        name = word.partition("=")[0]
        if not name.startswith("-"):
            self.error(f"unexpected argument: {shown(name)}")
        self.error(f"there is no option {shown(name)}{close(name, self.option_names())}")

    def format_help(self) -> str:
        for action in self._actions:
            if SAVED in (action.help or ""):
                from nodes.files import formats  # which takes numpy to load

                saved = " ".join(suffixes(*formats.SAVED))
                action.help = str(action.help).replace(SAVED, saved)
        return super().format_help()

    def print_help(self, file: Any = None) -> None:
        # argparse's own reports no error where the disk is full.
        print(self.format_help(), end="", file=file, flush=True)


class _Version(argparse.Action):
    # Read from the installation only when needed: it takes 20 ms.
    def __call__(self, parser: argparse.ArgumentParser, *_: Any, **__: Any) -> None:
        print(f"imagechain {version()}")
        parser.exit()


def parse(argv: list[str]) -> Options:
    """Read the command line; after printing the help or version, end by SystemExit."""
    if argv[0] == "help":  # as `--help`, of a command where one is named
        argv = [*(word for word in argv[1:2] if word != "help"), "--help"]
    first = argv[0]
    parser, commands = _parser(first)
    if not first.startswith("-") and first not in commands:
        hint = close(first, commands) or f"; there are {', '.join(commands)}"
        parser.error(f"there is no command {shown(first)}{hint}")
    used = commands.get(first, parser)
    if used is parser and first not in parser.option_names():
        parser.refuse(first)
    options, unknown = parser.parse_known_args(argv, Options())
    if unknown:
        used.refuse(unknown[0])
    given: dict[Word, Any] = vars(options).pop("given", {})
    for word, text in given.items():
        setattr(options, word.dest, word.value(first, text))
    return options


def _parser(used: str) -> tuple[_Parser, Mapping[str, _Parser]]:
    """The parser of all commands, and that of each; only the used one has its options."""
    from app.run.shipped import shipped_networks

    names = ", ".join(shipped_networks()) or "none"
    networks = textwrap.fill(
        names, 76, initial_indent="  ", subsequent_indent="  ", break_long_words=False,
        break_on_hyphens=False,
    )  # fmt: skip
    parser = _Parser(
        prog="imagechain",
        description="Simulate electro-optical and infrared image chains.",
        epilog=_EPILOG.format(networks=networks),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    # `--debug` is taken before the words come here: for the help, and what is like a wrong one.
    about_debug = "print Python's traceback before the error line"
    parser.add_argument("--debug", action="store_true", help=about_debug)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, (about, words) in COMMANDS.items():
        command = commands.add_parser(name, help=about, allow_abbrev=False)
        if name == used:  # the words of them all take longer to build than to read
            words(command)
            if name != "edit" and "--json" not in command.option_names():
                about_json = "print the result as JSON, and nothing else"
                command.add_argument("--json", action="store_true", help=about_json)
            command.add_argument("--debug", action="store_true", help=about_debug)
    return parser, commands.choices


def version() -> str:
    from importlib import metadata

    try:
        return metadata.version("imagechain")
    except metadata.PackageNotFoundError:
        return "(source tree)"
