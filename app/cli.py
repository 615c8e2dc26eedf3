"""The command ``imagechain``: exit codes 0 done, 2 a fault of the input, 1 a failure of ours."""

from __future__ import annotations

import os
import sys
import threading
import warnings
from collections.abc import Sequence

from app.stopping import Stopped, stoppable
from app.streams import discard, tell, usable_streams
from core.errors import Cancelled, ImagechainError


def main(argv: Sequence[str] | None = None) -> int:
    """Run a command line; stderr gets one line if it fails, else nothing.

    Parameters
    ----------
    argv : sequence of str, optional
        The words after the command's name; default those of the process.

    Returns
    -------
    int
        The exit code.
    """
    words = list(sys.argv[1:] if argv is None else argv)
    # The engine divides its work itself; BLAS threads beside its own only get in their way (the
    # whole process then takes 1.6 times the processor time). Read when numpy is first imported.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    with usable_streams(), warnings.catch_warnings(), stoppable() as told_to_stop:
        warnings.simplefilter("ignore")
        return _exit_code(words, told_to_stop)


def _exit_code(words: list[str], told_to_stop: threading.Event) -> int:
    """Carry out the words; what goes wrong becomes a line on stderr."""
    try:
        _carry_out(words, told_to_stop)
        sys.stdout.flush()
    except BrokenPipeError:  # the reader, such as `head`, has seen enough
        discard(sys.stdout)
    except ImagechainError as error:
        # A stop may have become anything, as numpy makes an ImportError of one.
        if told_to_stop.is_set():
            return _cancelled()
        return _fail(_with_more(error), error.exit_code)
    except KeyboardInterrupt:
        return _cancelled()
    except MemoryError:
        return _fail("not enough memory; nothing was written", 1)
    except OSError as error:
        discard(sys.stdout)
        return _fail(f"cannot write to the terminal or pipe: {error.strerror or error}", 2)
    except Exception as error:
        if told_to_stop.is_set():
            return _cancelled()
        return _fail(f"internal error: {type(error).__name__}: {error}", 1)
    return 0


def _carry_out(words: list[str], told_to_stop: threading.Event) -> None:
    from app import arguments

    try:
        options = arguments.parse(words or ["edit"])
    except SystemExit:  # help and version have been printed
        return
    if options.command == "run":
        from app.run import run

        _stop_if(told_to_stop)
        run(options, told_to_stop)
    elif options.command == "edit":
        from app.edit import edit

        edit(options, told_to_stop)
    elif options.command == "check":
        from app.check import check

        check(options)
    elif options.command == "tradeoff":
        from app.tradeoff.command import trade_off

        _stop_if(told_to_stop)
        trade_off(options, told_to_stop)
    elif options.command == "bench":
        from app.bench import bench

        _stop_if(told_to_stop)
        bench(options)
    else:
        from app.modules import modules

        modules(as_json=options.as_json, key=options.module)


def _stop_if(told_to_stop: threading.Event) -> None:
    """Stop after imports, which may have swallowed the exception."""
    if told_to_stop.is_set():
        raise Stopped


def _with_more(error: ImagechainError) -> str:
    more = getattr(error, "more", 0)
    return f"{error} (and {more} more: imagechain check)" if more else str(error)


def _cancelled() -> int:
    return _fail("cancelled; nothing was written", Cancelled.exit_code)


def _fail(message: str, code: int) -> int:
    line = " ".join(message.split())
    tell("imagechain: " + "".join(c if c.isprintable() else repr(c)[1:-1] for c in line))
    return code


if __name__ == "__main__":
    sys.exit(main())
