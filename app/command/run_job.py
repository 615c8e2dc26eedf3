"""A background run of the editor in a process of its own; the end of its input stops it.

The job is one line of input; output has lines of progress and the result.
"""

import _thread
import contextlib
import os
import signal
import sys
import threading

from app.command.cli import carried_out
from app.run.terminal import Stop

_NICE = 5  # the window comes first


def _carry_out(stop: Stop) -> None:
    from app.command.job_runs import carry_out
    from app.run.job import Job, Steps, message_line, read_message

    with contextlib.suppress(AttributeError, OSError):
        os.nice(_NICE)
    job = read_message(sys.stdin.buffer.readline().decode("ascii", "replace"))
    assert isinstance(job, Job)
    threading.Thread(target=_stop_at_end_of_input, args=(stop,), daemon=True).start()

    def write(line: str) -> None:
        with contextlib.suppress(OSError):  # nobody reads it any more: the input's end stops it
            print(line, flush=True)

    result = carry_out(job, stop, Steps(lambda step: write(message_line(step))))
    write(message_line(result))


def _stop_at_end_of_input(stop: Stop) -> None:
    with contextlib.suppress(OSError):
        while os.read(0, 4096):  # not by `sys.stdin`, whose lock the interpreter's end needs
            pass
    stop.set()
    if os.name == "posix":
        os.kill(os.getpid(), signal.SIGTERM)  # it wakes what waits, too
    else:
        _thread.interrupt_main()


if __name__ == "__main__":
    sys.exit(carried_out(_carry_out, hints=False))
