"""The command line's words; a wrong one is a `UsageError`, never a usage text on stderr."""

from __future__ import annotations

import argparse
import textwrap
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, NoReturn, cast

from app.options.camera_words import measure_words, netd_words, photon_transfer_words
from app.options.command_words import (
    bench_words,
    edit_words,
    fit_words,
    handbook_words,
    network_words,
    place_words,
    run_words,
    solve_words,
    study_words,
    tradeoff_words,
)
from app.options.option_values import (
    Assignment,
    Save,
    assignment,
    file_at_temperature,
    file_path,
    file_paths,
    finite_number,
    named_path,
    output_path,
    page_path,
    report_path,
    save_target,
    size_in_bytes,
    study_path,
    summary_path,
    tolerance,
    transfer_path,
    whole_number,
    window_size,
)
from core.errors import UsageError
from core.evaluation.policy import Precision
from core.modules.parameters import LARGEST_INTEGER
from core.names import close, shown
from nodes.files.common.file_format import CSV, HTML, JSON
from nodes.files.formats import PNG

_EPILOG = """\
shipped networks:
{networks}

exit codes:
  0  done
  1  a failure of the program, or stopped
  2  a fault of the input; one line on stderr says which

imagechain help COMMAND lists the options of a command; --set, --save, --report, --figure and
--output may be repeated, --vary be given twice, for a study any number of times."""
Look = Literal["dark", "light"]


@dataclass(frozen=True)
class Options:
    """What the command line gives."""

    command: Literal[
        "edit", "run", "check", "tradeoff", "study", "solve", "measure", "fit", "photon-transfer",
        "netd", "modules", "networks", "bench", "handbook",
    ]  # fmt: skip
    network: str = ""
    settings: tuple[Assignment, ...] = ()
    final: str | None = None
    scenes: tuple[str, ...] = ()
    scene: Mapping[str, Any] = field(default_factory=dict)
    saves: tuple[Save, ...] = ()
    output_dir: Path | None = None
    allowed: tuple[Path, ...] = ()
    reports: tuple[Path, ...] = ()
    frames: int | None = None
    all_readouts: bool = False
    memory_bytes: int | None = None
    scratch: Path | None = None
    vary: tuple[str, ...] = ()
    over: tuple[str, ...] = ()
    sample: str = "grid"
    points: int | None = None
    jobs: int | None = None
    scheduler: str = ""
    tls: tuple[str, ...] = ()
    fresh: bool = False
    summaries: tuple[Path, ...] = ()
    figures: tuple[str, ...] = ()
    outputs: tuple[Path, ...] = ()
    pictures: tuple[Path, ...] = ()
    band: int | None = None
    fov_x_deg: float | None = None
    pitch_um: float | None = None
    measured_json: Path | None = None
    measured_csv: Path | None = None
    flats: tuple[Path, ...] = ()
    dark: Path | None = None
    thermal_fields: tuple[tuple[Path, float], ...] = ()
    offset_dn: float | None = None
    solve_for: str = ""
    until: str = ""
    free: tuple[str, ...] = ()
    known_scene: bool = False
    fit_json: Path | None = None
    fit_output: Path | None = None
    fit_report: Path | None = None
    precision: Precision = "single"
    seed: int | None = None
    tolerance: float | None = None
    threads: int = 0
    as_json: bool = False
    module: str = ""
    word: str = ""
    html_folder: Path | None = None
    only_path: bool = False
    bench_json: Path | None = None
    bench_html: Path | None = None
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
        """Refuse an unknown option, or one word too many."""
        name = word.partition("=")[0]
        if not name.startswith("-"):
            self.error(f"{shown(name)} is one word too many")
        self.error(f"there is no option {shown(name)}{close(name, self.option_names())}")

    def print_help(self, file: Any = None) -> None:
        # argparse's own reports no error where the disk is full.
        print(self.format_help(), end="", file=file, flush=True)


class _Version(argparse.Action):
    # Read from the installation only when needed: it takes 20 ms.
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
        After printing the help or version.
    """
    arguments = _arguments(argv)
    if arguments.command in _SIMPLE:
        return _SIMPLE[arguments.command](arguments)
    if arguments.command == "bench":
        return Options(
            "bench",
            bench_json=file_path("--json", arguments.json),
            bench_html=file_path("--html", arguments.html),
            quick=arguments.quick,
            parts=tuple(arguments.only),
            size=whole_number("--size", arguments.size),
        )
    if arguments.command == "edit":
        shot = file_path("--screenshot", arguments.screenshot)
        if shot is not None and not PNG.matches(shot):
            raise UsageError(f"--screenshot {arguments.screenshot}: a name that ends in .png")
        return Options(
            "edit",
            arguments.network or "",
            screenshot=shot,
            window_size=window_size("--size", arguments.size),
            look=cast("Look | None", arguments.look),
            part=arguments.part,
        )
    settings = tuple(assignment("--set", text, "NODE.PARAM=VALUE") for text in arguments.set)
    if arguments.command == "check":
        return Options(
            "check",
            arguments.network,
            settings,
            final=arguments.final,
            **_scene(arguments),
            **_places(arguments),
        )
    common: dict[str, Any] = {
        "settings": settings,
        "final": arguments.final,
        "precision": arguments.precision,
        "tolerance": tolerance(arguments.tolerance),
        "seed": whole_number("--seed", arguments.seed, largest=LARGEST_INTEGER),
        "threads": whole_number("--threads", arguments.threads, largest=1024) or 0,
        **_scene(arguments),
    }
    if arguments.command == "tradeoff":
        return Options(
            "tradeoff",
            arguments.network,
            vary=tuple(arguments.vary),
            figures=tuple(arguments.figure),
            outputs=tuple(output_path(text) for text in arguments.output),
            **common,
        )
    if arguments.command == "study":
        return _study(arguments, common)
    if arguments.command == "fit":
        return _fit(arguments, common)
    return _solve_or_run(arguments, common)


def _solve_or_run(arguments: argparse.Namespace, common: dict[str, Any]) -> Options:
    if arguments.command == "solve":
        return Options(
            "solve",
            arguments.network,
            solve_for=arguments.solve_for,
            until=arguments.until,
            **common,
        )
    return Options(
        "run",
        arguments.network,
        saves=tuple(save_target(text) for text in arguments.save),
        reports=tuple(report_path(text) for text in arguments.report),
        frames=whole_number("--frames", arguments.frames),
        all_readouts=arguments.all,
        memory_bytes=size_in_bytes("--memory", arguments.memory),
        scratch=file_path("--scratch", arguments.scratch),
        **_places(arguments),
        **common,
    )


def _modules(arguments: argparse.Namespace) -> Options:
    return Options("modules", as_json=arguments.json, module=arguments.key or "")


def _handbook(arguments: argparse.Namespace) -> Options:
    folder = file_path("--html", arguments.html)
    if folder is not None and arguments.path:
        raise UsageError("--html DIR and --path exclude each other: --html prints its path")
    return Options(
        "handbook", word=arguments.word or "", html_folder=folder, only_path=arguments.path
    )


def _study(arguments: argparse.Namespace, common: dict[str, Any]) -> Options:
    return Options(
        "study",
        arguments.network,
        vary=tuple(arguments.vary),
        over=tuple(arguments.over),
        sample=arguments.sample,
        points=whole_number("--points", arguments.points),
        figures=tuple(arguments.figure),
        saves=tuple(save_target(text) for text in arguments.save),
        outputs=(study_path(arguments.output),),
        summaries=tuple(summary_path(text) for text in arguments.summary),
        jobs=whole_number("--jobs", arguments.jobs),
        memory_bytes=size_in_bytes("--memory", arguments.memory),
        scheduler=arguments.scheduler or "",
        tls=_tls(arguments),
        fresh=arguments.fresh,
        **common,
    )


def _tls(arguments: argparse.Namespace) -> tuple[str, ...]:
    """The three files of a connection by TLS, or none."""
    texts = {
        "--tls-ca-file": arguments.tls_ca_file,
        "--tls-cert": arguments.tls_cert,
        "--tls-key": arguments.tls_key,
    }
    missing = [option for option, text in texts.items() if text is None]
    if len(missing) == len(texts):
        return ()
    if missing:
        raise UsageError(f"{missing[0]} is missing: TLS needs {', '.join(texts)}")
    for option, text in texts.items():
        if not Path(text).is_file():
            raise UsageError(f"{option} {shown(text)}: there is no such file")
    return tuple(texts.values())


def _fit(arguments: argparse.Namespace, common: dict[str, Any]) -> Options:
    return Options(
        "fit",
        arguments.network,
        pictures=file_paths("--to", arguments.to),
        band=whole_number("--band", arguments.band),
        free=tuple(word for words in arguments.free for word in words),
        known_scene=arguments.known_scene,
        fit_json=named_path("--json", arguments.json, JSON),
        fit_output=named_path("--output", arguments.output, JSON),
        fit_report=page_path("--report", arguments.report),
        **common,
    )


def _photon_transfer(arguments: argparse.Namespace) -> Options:
    return Options(
        "photon-transfer",
        flats=file_paths("photon-transfer", arguments.flats),
        dark=file_path("--dark", arguments.dark),
        offset_dn=finite_number("--offset-dn", arguments.offset_dn),
        outputs=tuple(transfer_path(text) for text in arguments.output),
    )


def _netd(arguments: argparse.Namespace) -> Options:
    return Options(
        "netd",
        thermal_fields=tuple(file_at_temperature(text) for text in arguments.fields),
        outputs=tuple(transfer_path(text) for text in arguments.output),
    )


def _measure(arguments: argparse.Namespace) -> Options:
    report = named_path("--report", arguments.report, HTML)
    return Options(
        "measure",
        pictures=file_paths("measure", arguments.pictures),
        band=whole_number("--band", arguments.band),
        fov_x_deg=finite_number("--fov-x-deg", arguments.fov_x_deg),
        pitch_um=finite_number("--pitch-um", arguments.pitch_um),
        measured_json=named_path("--json", arguments.json, JSON),
        measured_csv=named_path("--csv", arguments.csv, CSV),
        reports=(report,) if report is not None else (),
        flats=file_paths("--flats", arguments.flats),
        dark=file_path("--dark", arguments.dark),
        offset_dn=finite_number("--offset-dn", arguments.offset_dn),
    )


_SIMPLE: Mapping[str, Callable[[argparse.Namespace], Options]] = MappingProxyType(
    {
        "networks": lambda _: Options("networks"),
        "modules": _modules,
        "photon-transfer": _photon_transfer,
        "netd": _netd,
        "measure": _measure,
        "handbook": _handbook,
    }
)


def _scene(arguments: argparse.Namespace) -> dict[str, Any]:
    """A picture in place of the scene, and what is said of it."""
    given: dict[str, Any] = {"unit": arguments.scene_unit or None}
    for name in ("fov_deg", "band_um"):
        texts = getattr(arguments, f"scene_{name}")
        option = f"--scene-{name.replace('_', '-')}"
        given[name] = texts and tuple(finite_number(option, text) for text in texts)
    for name in ("range_m", "sample_m"):
        option = f"--scene-{name.replace('_', '-')}"
        given[name] = finite_number(option, getattr(arguments, f"scene_{name}"))
    given = {name: value for name, value in given.items() if value is not None}
    for text in arguments.scene:
        file_path("--scene", text)
    if given and not arguments.scene:
        option = next(iter(given)).replace("_", "-")
        raise UsageError(f"--scene-{option} goes with --scene FILE")
    return {"scenes": tuple(arguments.scene), "scene": given}


def _places(arguments: argparse.Namespace) -> dict[str, Any]:
    """Where a run writes, and where its network may."""
    allowed = (file_path("--allow-writes-to", text) for text in arguments.allow_writes_to)
    return {
        "output_dir": file_path("--output-dir", arguments.output_dir),
        "allowed": tuple(folder for folder in allowed if folder is not None),
    }


def _arguments(argv: list[str]) -> argparse.Namespace:
    """The words as argparse reads them; an unknown one is refused with what is like it."""
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
    arguments, unknown = parser.parse_known_args(argv)
    if unknown:
        used.refuse(unknown[0])
    return arguments


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
    """The parser of all commands, and that of each; only the used one has its options."""
    parser = _Parser(
        prog="imagechain",
        description="Simulate electro-optical and infrared image chains.",
        epilog=_EPILOG.format(networks=_shipped()),
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version")
    # `--debug` is taken before the words come here: for the help, and what is like a wrong one.
    about_debug = "print Python's traceback before the line of an error"
    parser.add_argument("--debug", action="store_true", help=about_debug)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, (about, words) in _COMMANDS.items():
        command = commands.add_parser(name, help=about, allow_abbrev=False)
        if name == used:  # the words of them all take longer to build than to read
            words(command)
            command.add_argument("--debug", action="store_true", help=about_debug)
    return parser, commands.choices


def _check_words(parser: argparse.ArgumentParser) -> None:
    network_words(parser)
    place_words(parser)


def _modules_words(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "key",
        metavar="KEY|WORD",
        nargs="?",
        help="only this module, or those in whose key, title or summary this word stands",
    )
    parser.add_argument("--json", action="store_true", help="for programs")


_COMMANDS: Mapping[str, tuple[str, Callable[[argparse.ArgumentParser], object]]] = MappingProxyType(
    {
        "edit": ("open the editor", edit_words),
        "run": ("evaluate a network", run_words),
        "check": ("validate a network", _check_words),
        "tradeoff": ("figures of merit as a parameter moves", tradeoff_words),
        "study": ("figures and pictures at many points, over many scenes", study_words),
        "solve": ("the value of a parameter at which a read-out is as wanted", solve_words),
        "measure": ("edges, MTF and noise of pictures of a camera", measure_words),
        "fit": ("the parameters with which a network gives a real picture's edges", fit_words),
        "photon-transfer": (
            "gain, read noise and full well from frames of flat fields",
            photon_transfer_words,
        ),
        "netd": ("SiTF, NETD and 3-D noise from frames of black bodies", netd_words),
        "networks": ("list the shipped networks", lambda _: None),
        "modules": ("list the library", _modules_words),
        "bench": ("time against error", bench_words),
        "handbook": ("open the handbook, at any page", handbook_words),
    }
)


def version() -> str:
    """The installed version of this program."""
    from importlib import metadata

    try:
        return metadata.version("imagechain")
    except metadata.PackageNotFoundError:
        return "(source tree)"
