"""The command ``imagechain``: exit codes 0 done, 2 a fault of the input, 1 a failure of ours."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import warnings
from collections.abc import Iterator, Sequence
from typing import Any

from core.errors import Cancelled, ImagechainError, UsageError


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
    with _settled() as told_to_stop:
        try:
            _carry_out(words)
            sys.stdout.flush()
        except BrokenPipeError:  # the reader, such as `head`, has seen enough
            _close_stdout()
        except SystemExit as leaving:  # help and version
            return int(leaving.code or 0)
        except ImagechainError as error:
            return _fail(_with_more(error), error.exit_code)
        except KeyboardInterrupt:
            return _fail("cancelled; nothing was written", Cancelled.exit_code)
        except MemoryError:
            return _fail("not enough memory; nothing was written", 1)
        except OSError as error:
            _close_stdout()
            return _fail(f"cannot write to the terminal or pipe: {error.strerror or error}", 2)
        except Exception as error:
            if told_to_stop:  # whatever it became, as numpy makes an ImportError of it
                return _fail("cancelled; nothing was written", Cancelled.exit_code)
            return _fail(f"internal error: {type(error).__name__}: {error}", 1)
    return 0


def _carry_out(words: list[str]) -> None:
    from app import arguments

    if not words:
        print(arguments.help_text(), end="")
        raise UsageError("say what to do: run, check or modules")
    options = arguments.parse(words)
    if options.command == "run":
        from app.run import run

        run(options)
    elif options.command == "check":
        from app.check import check

        check(options)
    else:
        from app.modules import modules

        modules(as_json=options.as_json)


def _with_more(error: ImagechainError) -> str:
    more = getattr(error, "more", 0)
    return f"{error} (and {more} more: imagechain check)" if more else str(error)


def _fail(message: str, code: int) -> int:
    line = " ".join(message.split())
    shown = "".join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in line)
    print(f"imagechain: {shown}", file=sys.stderr)
    return code


def _close_stdout() -> None:
    """What is left in its buffer goes nowhere: the interpreter must not try again at its end."""
    with contextlib.suppress(OSError, ValueError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


@contextlib.contextmanager
def _settled() -> Iterator[list[int]]:
    """No warnings, names of any alphabet, and a polite end when told to stop.

    Yields the signals that told to.
    """
    for stream in (sys.stdout, sys.stderr):
        if hasattr(stream, "reconfigure"):
            stream.reconfigure(errors="backslashreplace")
    told_to_stop: list[int] = []
    previous = _on_stop(told_to_stop)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield told_to_stop
    finally:
        for number, handler in previous.items():
            signal.signal(number, handler)


class _Stopped(KeyboardInterrupt):
    """Told to stop.

    A class of its own: after a plain KeyboardInterrupt inside ``exec`` (as dataclasses use it) the
    interpreter ends by the signal, however well it was caught.
    """


def _on_stop(told_to_stop: list[int]) -> dict[signal.Signals, Any]:
    """Make Ctrl-C and SIGTERM stop the work; gives what to restore."""

    def stop(number: int, _frame: object) -> None:
        told_to_stop.append(number)
        raise _Stopped

    previous: dict[signal.Signals, Any] = {}
    with contextlib.suppress(ValueError):  # not the main thread
        for number in (signal.SIGINT, signal.SIGTERM):
            if signal.getsignal(number) != signal.SIG_IGN:
                previous[number] = signal.signal(number, stop)
    return previous


if __name__ == "__main__":
    sys.exit(main())
