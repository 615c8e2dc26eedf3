"""The process of a background run, as the editor starts it."""

import contextlib
import subprocess

from app.run.job import Result, job_text, read_message
from app.run.shipped import command, environment
from child_process import PATIENCE_S


@contextlib.contextmanager
def started(job):
    """Its process, which has been given the job; it is stopped at the end."""
    with subprocess.Popen(
        command("app.command.run_job"),
        env=environment(),
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    ) as child:
        try:
            child.stdin.write(job_text(job) + "\n")
            child.stdin.flush()
            yield child
        finally:
            child.kill()


def finished_job(job):
    """Exit code, result and standard error of a job; its input stays open to the end."""
    with started(job) as child:
        messages = [read_message(line.rstrip("\n")) for line in child.stdout]
        said = child.stderr.read()
        code = child.wait(PATIENCE_S)
    results = [message for message in messages if isinstance(message, Result)]
    return code, results[-1] if results else None, said
