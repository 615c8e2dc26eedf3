"""The command ``imagechain``: exit codes 0 done, 2 a fault of the input, 1 a failure of ours."""

from __future__ import annotations

import gc
import os
import sys
import traceback
import warnings
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path

from app.options.stopping import Stop, Stopped, stoppable
from app.options.terminal_streams import discard, print_error, usable_streams
from core.errors import Cancelled, ImagechainError, InputError, Suspended

DEBUG = "--debug"


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line; stderr gets one line if it fails, else nothing.

    With ``--debug`` anywhere among the words, Python's traceback comes before that line.
    """
    given = list(sys.argv[1:] if argv is None else argv)
    words = [word for word in given if word != DEBUG]
    # The engine divides its work itself; BLAS threads beside its own only get in their way (the
    # whole process then takes 1.6 times the processor time). Read when numpy is first imported.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    # Importing makes some 90,000 objects that all stay; Python's usual threshold (700) looks them
    # through time and again for garbage, a tenth of a short command's processor time. Only where
    # the process is the command's own: another program has thresholds of its own.
    if argv is None:
        gc.set_threshold(50_000, 10, 10)
    with stoppable(to_the_end=argv is None) as stop, usable_streams(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return exit_code(stop, _carry_out, words, stop, debug=words != given)


def exit_code(
    stop: Stop,
    carry_out: Callable[..., object],
    *words: object,
    debug: bool = False,
    hints: bool = True,
) -> int:
    """Call a function that a signal may stop; what goes wrong becomes a line on stderr.

    `hints`: whether that line may name options, as it is read beside a command line.
    """
    try:
        stop.during(carry_out, *words)
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
    gone = "" if _has_folder() else "the current folder has been removed: change to another one"
    if isinstance(error, ImagechainError):
        gone = f" ({gone})" if gone and error.exit_code == InputError.exit_code else ""
        hint = f"; {error.hint}" if hints and error.hint else ""
        return _fail(_with_more(error) + hint + gone, error.exit_code)
    if gone and isinstance(error, FileNotFoundError):
        return _fail(gone, 2)
    if isinstance(error, MemoryError):
        what = "the files are written" if written else "nothing was written"
        return _fail(f"not enough memory; {what}", 1)
    if isinstance(error, OSError) and error.filename is not None:
        what = "; the files are written" if written else "; nothing was written"
        return _fail(f"cannot use {error.filename}: {error.strerror or error}{what}", 2)
    if isinstance(error, OSError):
        discard(sys.stdout)
        what = "; the files are written" if written else ""
        # Not 2: nothing of the input could be mended.
        return _fail(f"cannot write to standard output: {error.strerror or error}{what}", 1)
    frames = traceback.extract_tb(error.__traceback__)
    place = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
    what = f"internal error: {type(error).__name__}: {error}{place}"
    return _fail(f"{what}; {DEBUG} prints the traceback" if hints else what, 1)


def _carry_out(words: list[str], stop: Stop) -> None:
    from app.options.command_options import parse
    from app.run.shipped import find_network

    try:
        options = parse(words or ["edit"])
    except SystemExit:  # help and version have been printed
        return
    if options.network:
        find_network(options.network)  # a misspelt name is told before what takes long to load
    # Only now, as it may take long: a command is a module of its name.
    command = import_module(f"app.command.{options.command.replace('-', '_')}")
    if stop.is_set():  # an import may have swallowed the exception
        raise Stopped
    command.carry_out(options, stop)


def _has_folder() -> bool:
    try:
        os.getcwd()  # noqa: PTH109
    except OSError:
        return False
    return True


def _with_more(error: ImagechainError) -> str:
    more = getattr(error, "more", 0)
    return f"{error} (and {more} more: imagechain check lists them)" if more else str(error)


def _cancelled() -> int:
    return _fail("cancelled; nothing was written", Cancelled.exit_code)


def _fail(message: str, code: int) -> int:
    line = " ".join(message.split())
    print_error("imagechain: " + "".join(c if c.isprintable() else repr(c)[1:-1] for c in line))
    return code


if __name__ == "__main__":
    sys.exit(main())
