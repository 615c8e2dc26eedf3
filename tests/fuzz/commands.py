"""Commands of the program run in this process, and what must hold of each."""

import contextlib
import io
import types
import warnings
from dataclasses import dataclass
from pathlib import Path

from cases import Case

import app.command.cli


@dataclass(frozen=True)
class Ended:
    """How a command ended."""

    code: int
    out: str
    err: str


# The command ignores warnings; here each is an error, and so a finding.
app.command.cli.warnings = types.SimpleNamespace(  # type: ignore[attr-defined]
    catch_warnings=warnings.catch_warnings, simplefilter=lambda *_: warnings.simplefilter("error")
)


def ended(case: Case, words: list[str]) -> Ended:
    """Run a command line; ends of other kinds than 0, or 2 with one line, are findings."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = app.command.cli.main(words)
    end = Ended(code, out.getvalue(), err.getvalue())
    said = f"imagechain {' '.join(words)}: exit code {code}: {end.err[:600]!r}"
    case.expect(code in (0, 2), said)
    if code == 0:
        case.expect(not end.err, f"success with words on stderr: {said}")
    else:
        case.expect(is_one_line(end.err), f"not one plain line: {said}")
    case.counts[f"{words[0]}: exit code {code}"] += 1
    return end


def is_one_line(text: str) -> bool:
    """Whether it is one line of printable text that says something."""
    line = text.removesuffix("\n")
    begins = line.startswith("imagechain: ") and len(line) > len("imagechain: ") + 8
    return text.endswith("\n") and line.isprintable() and begins


def contents(folder: Path) -> dict[str, bytes]:
    """Every file below a folder with its bytes."""
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in sorted(folder.rglob("*"))
        if path.is_file()
    }
