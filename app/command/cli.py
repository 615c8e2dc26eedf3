"""The command ``imagechain``: exit codes 0 done, 2 a fault of the input, 1 a failure of ours."""

import gc
import os
import sys
import traceback
import warnings
from collections.abc import Callable, Sequence
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import click

from app.command.options import DEBUG, DEBUGGING, PlainErrors
from app.run.terminal import Stop, discard, print_error, stoppable, usable_streams, version
from core.errors import Cancelled, ImagechainError, InputError, Suspended, UsageError, close, shown

# The commands, each a function, by the file that it is in.
_FILES = {
    "run_commands": ["edit", "run", "check"],
    "study_commands": ["tradeoff", "study", "solve"],
    "camera_commands": ["measure", "fit", "photon-transfer", "netd"],
    "library_commands": ["networks", "modules", "presets", "bench", "handbook"],
}
COMMANDS = {name: file for file, names in _FILES.items() for name in names}
_EPILOG = {
    "Exit codes": "\b\n0  done\n1  the program failed or was stopped\n"
    "2  the input has an error, reported in one line on stderr",
    "More": "imagechain help COMMAND lists the options of a command. --set, --save, --report, "
    "--figure and --output may be repeated. tradeoff takes --vary once or twice, study any "
    "number of times.",
}


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line; if it fails, stderr gets one line, with --debug after the traceback."""
    if argv is None and "_IMAGECHAIN_COMPLETE" in os.environ:  # a shell wants the words to type
        COMMAND_LINE.main(prog_name="imagechain")
    given = list(sys.argv[1:] if argv is None else argv)
    words = [word for word in given if word != DEBUG]
    carry_out = partial(_carry_out, words)
    return carried_out(carry_out, own_process=argv is None, debug=words != given)


def carried_out(
    carry_out: Callable[[Stop], object],
    *,
    own_process: bool = True,
    debug: bool = False,
    hints: bool = True,
) -> int:
    """Call what a signal may stop, for its exit code; `hints`: its line of error names options."""
    # The engine divides its work itself; BLAS threads beside its own only get in their way (the
    # whole process then takes 1.6 times the processor time). Read when numpy is first imported.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Importing makes some 90,000 objects that all stay; Python's usual threshold (700) looks them
    # through time and again for garbage, and once more at the end: a tenth of a short command's
    # processor time. Only where the process is the command's own: another program has its own ways.
    if own_process:
        gc.set_threshold(200_000, 10, 10)
    with stoppable(to_the_end=own_process) as stop, usable_streams(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        code = _exit_code(stop, carry_out, debug=debug, hints=hints)
    if own_process:
        gc.disable()
    return code


def _exit_code(stop: Stop, carry_out: Callable[[Stop], object], *, debug: bool, hints: bool) -> int:
    try:
        stop.during(carry_out, stop)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader, such as `head`, has seen enough
        discard(sys.stdout)
    except KeyboardInterrupt:
        return _cancelled()
    except Exception as error:
        # A stop may have become anything, as numpy makes an ImportError of one.
        if stop.is_set() and not (stop.is_late or isinstance(error, Suspended)):
            return _cancelled()
        if debug:
            shown = getattr(error, "fault", None) or error
            print_error("".join(traceback.format_exception(shown)).rstrip())
        return _failed(error, written=stop.is_late, hints=hints)
    return 0


def _failed(error: Exception, *, written: bool, hints: bool) -> int:
    """Print what went wrong; `written` when only the printing was left to do."""
    gone = "" if _has_folder() else "the current folder has been removed: change to another folder"
    if isinstance(error, ImagechainError):
        gone = f" ({gone})" if gone and error.exit_code == InputError.exit_code else ""
        hint = f"; {error.hint}" if hints and error.hint else ""
        more = len(getattr(error, "problems", ())) - 1
        said = f"{error} (and {more} more: imagechain check lists them)" if more > 0 else str(error)
        return _fail(said + hint + gone, error.exit_code)
    if gone and isinstance(error, FileNotFoundError):
        return _fail(gone, 2)
    if isinstance(error, MemoryError):
        what = "the files were written" if written else "nothing was written"
        return _fail(f"not enough memory; {what}", 1)
    if isinstance(error, OSError) and error.filename is not None:
        what = "; the files were written" if written else "; nothing was written"
        return _fail(f"cannot use {error.filename}: {error.strerror or error}{what}", 2)
    if isinstance(error, OSError):
        discard(sys.stdout)
        what = "; the files were written" if written else ""
        # Not 2: nothing of the input could be mended.
        return _fail(f"cannot write to standard output: {error.strerror or error}{what}", 1)
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    what = f"internal error: {type(error).__name__}: {error}{place}"
    return _fail(f"{what}; {DEBUG} prints the traceback" if hints else what, 1)


class _Commands(PlainErrors, click.Group):
    """The commands; only the one that is used is loaded."""

    def list_commands(self, ctx: click.Context) -> list[str]:  # noqa: ARG002
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:  # noqa: ARG002
        if cmd_name not in COMMANDS:
            return None
        module = import_module(f"app.command.{COMMANDS[cmd_name]}")
        found: click.Command = getattr(module, cmd_name.replace("-", "_"))
        return found

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        if args[0] not in COMMANDS:
            hint = close(args[0], COMMANDS) or f"; the commands are {', '.join(COMMANDS)}"
            raise UsageError(f"there is no command {shown(args[0])}{hint} (imagechain --help)")
        return super().resolve_command(ctx, args)

    def format_epilog(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:  # noqa: ARG002
        from app.run.shipped import shipped_networks

        for title, text in {"Example networks": ", ".join(shipped_networks()), **_EPILOG}.items():
            with formatter.section(title):
                formatter.write_text(text)


def _print_version(ctx: click.Context, _option: click.Parameter, wanted: bool) -> None:
    if wanted:
        print(f"imagechain {version()}")
        ctx.exit()


COMMAND_LINE = _Commands(
    "imagechain",
    help="Simulate electro-optical and infrared image chains.",
    context_settings={"max_content_width": 100, "help_option_names": ["-h", "--help"]},
    params=[
        click.Option(
            ["--version"], is_flag=True, is_eager=True, expose_value=False,
            callback=_print_version, help="print the version",
        ),
        DEBUGGING,
    ],
)  # fmt: skip


def _carry_out(words: list[str], stop: Stop) -> None:
    if words[:1] == ["help"]:  # as `--help`, of a command where one is named
        words = [*(word for word in words[1:2] if word != "help"), "--help"]
    elif words[:1] == ["--"]:
        raise UsageError("'--' is not allowed before a command (imagechain --help)")
    try:
        with COMMAND_LINE.make_context("imagechain", words or ["edit"], obj=stop) as context:
            COMMAND_LINE.invoke(context)
    except click.exceptions.Exit:  # help and version have been printed
        return


def _has_folder() -> bool:
    try:
        os.getcwd()  # noqa: PTH109
    except OSError:
        return False
    return True


def _cancelled() -> int:
    return _fail("cancelled; nothing was written", Cancelled.exit_code)


def _fail(message: str, code: int) -> int:
    line = " ".join(message.split())
    print_error("imagechain: " + "".join(c if c.isprintable() else repr(c)[1:-1] for c in line))
    return code


if __name__ == "__main__":
    sys.exit(main())
