"""How a command declares its words with click, and what it prints and leaves."""

from __future__ import annotations

import functools
import sys
import threading
import time
from collections.abc import Callable, Iterable, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self, TypeVar

import click

from app.run import option_values, shipped, terminal
from core.errors import Cancelled, UsageError, close, shown
from core.modules.parameters import LARGEST_INTEGER
from nodes.files.file_format import JSON, Format, suffixes

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from app.run.overrides import GivenNetwork
    from core.modules.declaration import Library
    from core.network.network import Network

SAVED = "SAVED"  # in a help, for the suffixes of what a port can be saved as
GROUPS = ("Arguments", "Options", "A picture of your own", "Options for rarer cases")
ARGUMENTS, EVERYDAY, SCENE, RARER = GROUPS
DEBUG = "--debug"  # taken before the words come to click: for the help
DEBUGGING = click.Option(
    [DEBUG], is_flag=True, expose_value=False, help="print Python's traceback before the error line"
)
Read = Callable[[str, str], Any]
Function = Callable[..., Any]


def _completed(
    word: click.Parameter, ctx: click.Context, incomplete: str  # noqa: ARG001
) -> list[CompletionItem]:  # fmt: skip
    """What a shell may complete: the names of networks where one is wanted, else files."""
    from click.shell_completion import CompletionItem

    names = shipped.every_network() if word.name == "network" else ()
    found = [CompletionItem(name) for name in names if name.startswith(incomplete)]
    return found or [CompletionItem(incomplete, type="file")]


class Option(click.Option):
    """An option of a group of the help; `several` takes all texts up to the next option."""

    shell_complete = _completed

    def __init__(self, names: Sequence[str], **how: Any) -> None:
        self.group: str = how.pop("group")
        self.several: bool = how.pop("several", False)
        super().__init__(names, **how)


class Argument(click.Argument):
    shell_complete = _completed

    def __init__(self, names: Sequence[str], *, about: str, **how: Any) -> None:
        super().__init__(names, **how)
        self.group, self.about = ARGUMENTS, about


class PlainErrors(click.Command):
    """Says in one line of ours what is wrong with the words."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        words = [*args]
        try:
            return super().parse_args(ctx, args)
        except click.UsageError as error:
            what = _what_is_wrong(error, ctx, words)
            raise UsageError(f"{what} ({ctx.command_path} --help)") from error

    def get_help_option(self, ctx: click.Context) -> click.Option | None:
        option = super().get_help_option(ctx)
        if option is not None:
            option.help = "show this help"
        return option


def _what_is_wrong(error: click.UsageError, ctx: click.Context, words: list[str]) -> str:
    parameters = ctx.command.get_params(ctx)
    options = {name: parameter for parameter in parameters for name in parameter.opts}
    match error:
        case click.NoSuchOption():
            names = [name for name in options if name.startswith("-")]
            return f"there is no option {shown(error.option_name)}{close(error.option_name, names)}"
        case click.MissingParameter():  # what is given has been read before
            missing = [one for one in parameters if one.required and one.name not in ctx.params]
            names = [
                str(one.metavar).removesuffix("...") if isinstance(one, Argument) else one.opts[0]
                for one in missing
            ]
            return f"the following arguments are required: {', '.join(names)}"
        case click.BadOptionUsage():
            name = error.option_name
            option = options[name]
            if getattr(option, "is_flag", False):
                given = next(word for word in words if word.startswith(f"{name}="))
                return f"argument {name}: takes no value, but {given[len(name) + 1 :]!r} is given"
            many = "at least one" if getattr(option, "several", False) else "one"
            wants = f"{many} argument" if option.nargs == 1 else f"{option.nargs} arguments"
            return f"argument {name}: expected {wants}"
        case _:
            return error.message


class Command(PlainErrors):
    """A command whose function gets, before its options, the event that is set to stop it."""

    allow_extra_args = True  # refused below, in the words of the other errors

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        """Write ``--free A B`` as ``--free A --free B``, which click knows how to read."""
        options = [option for option in self.params if isinstance(option, Option)]
        several = {option.opts[0] for option in options if option.several}
        words: list[str] = []
        current = ""
        for word in args:
            if word.startswith("-"):
                current = word if word in several else ""
            elif current and words[-1] != current:
                words.append(current)
            words.append(word)
        super().parse_args(ctx, words)
        if ctx.args and not ctx.resilient_parsing:
            word = shown(ctx.args[0].partition("=")[0])
            raise UsageError(f"unexpected argument: {word} ({ctx.command_path} --help)")
        return ctx.args

    def get_params(self, ctx: click.Context) -> list[click.Parameter]:
        return [*super().get_params(ctx), DEBUGGING]

    def invoke(self, ctx: click.Context) -> Any:
        assert self.callback is not None
        return self.callback(ctx.obj, **ctx.params)

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        groups: dict[str, list[tuple[str, str]]] = {}
        for parameter in self.get_params(ctx):
            if isinstance(parameter, Argument):
                record = str(parameter.metavar), parameter.about
            else:
                record = parameter.get_help_record(ctx) or ("", "")
            groups.setdefault(getattr(parameter, "group", RARER), []).append(record)
        for title in sorted(groups, key=GROUPS.index):
            with formatter.section(title):
                formatter.write_dl([(name, _with_suffixes(text)) for name, text in groups[title]])


def _with_suffixes(about: str) -> str:
    if SAVED not in about:
        return about
    from nodes.files import formats  # which takes numpy to load

    return about.replace(SAVED, " ".join(suffixes(*formats.SAVED)))


command = functools.partial(click.command, cls=Command)
"""Makes a function the command of its name; its docstring is the help."""


def option(
    name: str,
    metavar: str,
    about: str,
    read: Read | None = None,
    *,
    to: str = "",
    group: str = EVERYDAY,
    many: bool = False,
    default: Any = None,
    **how: Any,
) -> Callable[[Function], Function]:
    """An option with a text behind it, in the parameter `to` of the function."""

    def value(_context: click.Context, option: click.Parameter, given: Sequence[Any] | None) -> Any:
        texts = [_read(read, option, text) for text in given or ()]
        if many:
            return tuple(texts)
        if len(texts) > 1:
            raise click.UsageError(f"{name} is given more than once")
        return texts[0] if texts else default

    return click.option(
        name, *([to] if to else []), cls=Option, metavar=metavar, help=about, multiple=True,
        callback=value, type=click.UNPROCESSED, group=group, **how,
    )  # fmt: skip


def flag(
    name: str, about: str, group: str = EVERYDAY, to: str = ""
) -> Callable[[Function], Function]:
    names = [name, *([to] if to else [])]
    return click.option(*names, cls=Option, is_flag=True, help=about, group=group)


def argument(
    to: str, metavar: str, about: str, read: Read | None = None, *, many: bool = False,
    required: bool = True,
) -> Callable[[Function], Function]:  # fmt: skip
    def value(context: click.Context, _argument: click.Parameter, given: Any) -> Any:
        name = str(context.info_name)
        texts = given if many else [given or ""]
        values = tuple(text if read is None else read(name, text) for text in texts)
        return values if many else values[0]

    return click.argument(
        to, cls=Argument, metavar=metavar, about=about, nargs=-1 if many else 1, required=required,
        callback=value, type=click.UNPROCESSED,
    )  # fmt: skip


def _read(read: Read | None, option: click.Parameter, text: Any) -> Any:
    name = option.opts[0]
    if isinstance(text, tuple):
        return tuple(_read(read, option, part) for part in text)
    if not isinstance(text, str):
        return text
    if text.startswith("--"):  # the next option, where click expects a value
        raise click.BadOptionUsage(name, "")
    return text if read is None else read(name, text)


def one_of(*choices: str) -> Read:
    def read(option: str, text: str) -> str:
        if text in choices:
            return text
        known = ", ".join(map(repr, choices))
        raise click.UsageError(f"argument {option}: invalid choice: {text!r} (choose from {known})")

    return read


def together(*options: Callable[[Function], Function]) -> Callable[[Function], Function]:
    return lambda function: functools.reduce(lambda made, one: one(made), options[::-1], function)


json_flag = flag("--json", "print only the result, as JSON", RARER)


def json_file(about: str, read: Read | None = None) -> Callable[[Function], Function]:
    about += "; without FILE, print only the JSON"
    how: dict[str, Any] = {"is_flag": False, "flag_value": True}  # without FILE, True
    return option("--json", "[FILE]", about, read or option_values.ending_in(JSON), **how)


def save_option(metavar: str, about: str) -> Callable[[Function], Function]:
    read: Read = lambda _, text: option_values.save_target(text)  # noqa: E731
    return option("--save", metavar, about, read, many=True, to="saves")


def written_outputs(about: str, formats: Sequence[Format]) -> Callable[[Function], Function]:
    about += f", as {' '.join(suffixes(*formats))}; may be repeated"
    return option(
        "--output", "FILE", about, option_values.ending_in(*formats), to="outputs", many=True
    )


def network_options(function: Function) -> Function:
    """A network and what is changed in it, as `GivenNetwork`."""

    @functools.wraps(function)
    def given(
        stop: object, /, network: str, settings: Any, disabled: Any, final: Any, scenes: Any,
        seed: int | None = None, **more: Any,
    ) -> Any:  # fmt: skip
        details = {name: more.pop(name) for name in [*more] if name.startswith("scene_")}
        place = shipped.find_network(network)
        from app.run.overrides import GivenNetwork

        asked = GivenNetwork(place, settings, disabled, final, scenes, details, seed)
        return function(stop, asked, **more)

    rare, scene = partial(option, group=RARER), partial(option, group=SCENE)
    return together(
        argument("network", "NETWORK", "a network file, or the name of an example network"),
        option("--set", "NODE.PARAM=VALUE",
            "change a parameter for this run; null clears it; may be repeated",
            partial(option_values.assignment, form="NODE.PARAM=VALUE"), many=True, to="settings"),
        option("--disable", "NODE",
            "disable a node for this run: the node passes its input through; may be repeated",
            many=True, to="disabled"),
        rare("--final", "NODE.PORT",
            "use this picture as the network's output, instead of the one marked in the file"),
        scene("--scene", "[NODE=]FILE",
            "use this picture or cube as the scene; NODE selects one of several scenes",
            _scene, many=True, to="scenes"),
        scene("--scene-fov-deg", "X Y",
            "field of view of the scene (default: from the file's header, else the width or height "
            "of the original scene)",
            option_values.finite_number, nargs=2),
        scene("--scene-range-m", "M", "distance to the scene", option_values.finite_number),
        scene("--scene-sample-m", "M", "size of a scene sample, instead of the scene's field of "
            "view", option_values.finite_number),
        scene("--scene-band-um", "A B",
            "wavelength band of the scene (default: from the file's header, else the original "
            "scene's band)",
            option_values.finite_number, nargs=2),
        scene("--scene-unit", "UNIT",
            "unit of the scene: a radiance unit, K, C, reflectance, or relative (scaled to the "
            "range of the original scene); default: the file's unit, else relative"),
    )(given)  # fmt: skip


def _scene(option: str, text: str) -> str:
    option_values.file_path(option, text)
    return text


def opened(asked: GivenNetwork, json: bool) -> tuple[Library, shipped.Place, Network]:
    from nodes.library import standard_library

    library = standard_library()
    network, lines = asked.opened(library)
    say(json, *lines)
    return library, asked.place, network


def place_options(function: Function) -> Function:
    """Where the network's files go: `output_dir` and `allowed`."""
    return together(
        option("--output-dir", "DIR",
            "folder for final.png, mtf.csv and readouts.json (default ./NAME-output)",
            option_values.file_path),
        option("--allow-writes-to", "DIR",
            "let the network's nodes write and replace any file below DIR. By default they write "
            "only to the network's folder and the output folder, and replace only files that this "
            "network has written. May be repeated", option_values.file_path,
            many=True, to="allowed", group=RARER),
    )(function)  # fmt: skip


def numerical_options(function: Function) -> Function:
    """Seed and accuracy: the seed goes to the network, the rest is its `policy`."""

    @functools.wraps(function)
    def given(*words: Any, precision: Any, tolerance: Any, threads: int, **more: Any) -> Any:
        from core.evaluation.work import Policy

        return function(*words, policy=Policy(precision, tolerance, threads), **more)

    number = partial(option, group=RARER)
    return together(
        option("--seed", "N", "seed for the noise, instead of the network's seed",
            partial(option_values.whole_number, largest=LARGEST_INTEGER)),
        number("--precision", "[single|double]", "default: single", one_of("single", "double"),
            default="single"),
        number("--tolerance", "T",
            "error budget, from 0 to below 1: leave out stages that together change the picture "
            "by less than this fraction of its range. Default: below the samples' rounding "
            "error; 1e-4 of each band's contrast if a few wavelengths represent all bands. 0 "
            "leaves out only stages that change nothing", option_values.tolerance),
        number("--threads", "N", "worker threads (default: all)",
            partial(option_values.whole_number, largest=1024), default=0),
    )(given)  # fmt: skip


Made = TypeVar("Made")
PATIENCE_S = 0.7


def written(
    outputs: Sequence[Path],
    inputs: Iterable[Path],
    stop: threading.Event,
    make: Callable[[], Made],
    content: Callable[[Made, Path], str | bytes],
) -> Made:
    """Make a result, and write what each file is to hold; files are reserved before any work."""
    from app.run.staging import Staging  # which takes numpy to load

    with Staging(None, inputs) as staging:
        for path in outputs:
            staging.claim(path)
        made = make()
        for path in outputs:
            staging.write(path, partial(write_content, content=content(made, path)))
        check_stop(stop)
        terminal.too_late(stop)
        staging.commit()
    return made


def write_content(path: Path, content: str | bytes) -> None:
    from core.atomic import write_bytes, write_text  # only where files are written

    if isinstance(content, bytes):
        write_bytes(path, content)
    else:
        write_text(path, content)


def check_stop(stop: threading.Event) -> None:
    if stop.is_set():
        raise Cancelled("stopped on request")


def say(json: object, *lines: str) -> None:
    """Print lines for people; none where the result is printed as JSON."""
    if lines and json is not True:
        print("\n".join(lines), flush=True)


def show(json: object, facts: Callable[[], Any], *lines: str) -> None:
    """Print the result of a command: as JSON where `json` is True, else in lines."""
    say(json, *lines)
    if json is True:
        print(terminal.json_text(facts()), end="", flush=True)


class Progress:
    """Shows which node computes; silent where stderr is no terminal."""

    def __init__(self, total: int, *, time_left: bool = False) -> None:
        self._total = total
        self._time_left = time_left
        self._start = time.perf_counter()
        self._seen: set[str] = set()
        self._bar: Any = None
        self._task: Any = None
        self._wanted = sys.stderr is not None and sys.stderr.isatty()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._bar is not None:
            self._bar.stop()

    def __call__(self, node: str | None) -> None:
        if node:
            self._seen.add(node)
        self.reach(len(self._seen), node or "")

    def reach(self, done: int, text: str) -> None:
        if not self._wanted:
            return
        if self._bar is None:
            if time.perf_counter() - self._start < PATIENCE_S:
                return
            self._begin()
        self._bar.update(self._task, completed=done, description=text)

    def _begin(self) -> None:
        from rich import progress
        from rich.console import Console

        self._bar = progress.Progress(
            progress.BarColumn(),
            progress.MofNCompleteColumn(),
            *([progress.TimeRemainingColumn()] if self._time_left else []),
            progress.TextColumn("{task.description}", markup=False),
            console=Console(stderr=True),
            transient=True,  # stderr is for one line of error
        )
        self._task = self._bar.add_task("", total=self._total)
        self._bar.start()
