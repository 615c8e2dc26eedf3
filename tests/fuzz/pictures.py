"""Damage picture files at random and judge what the readers make of them.

``python tests/fuzz/pictures.py --count 10000 --seed 1`` prints a table of verdicts by kind of file
and ends with 1 where a picture was accepted that a checksum of its format could have caught, where
samples differ from read to read, or where a reader failed otherwise than by its own error.
"""

import argparse
import hashlib
import multiprocessing
import os
import re
import shutil
import sys
import tempfile
import warnings
from collections import Counter
from dataclasses import replace
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent), str(ROOT / "tests" / "support")]

from picture_kinds import KINDS, Made  # noqa: E402

REFUSED, EQUAL, UNGUARDED = "refused", "as it was", "other samples, no checksum"
WRONG, INTERNAL, DIFFERS = "WRONG: a checksum knew", "INTERNAL ERROR", "DIFFERS BY READ"
CRASH, HANG = "CRASH", "HANG"
VERDICTS = (REFUSED, EQUAL, UNGUARDED, WRONG, INTERNAL, DIFFERS, CRASH, HANG)
FAULTS = frozenset(VERDICTS[3:])
PATIENCE_S = 60.0
# What fresh memory is filled with: memory that nobody wrote to differs between the two readers.
FILLINGS = (85, 170)


class Reader:
    """A process that reads pictures, so that a crash or a hang of it is a verdict."""

    def __init__(self, filling: int) -> None:
        self._filling = filling
        self._start()

    def _start(self) -> None:
        context = multiprocessing.get_context("spawn")
        ours, theirs = context.Pipe()
        kept = {name: os.environ.get(name) for name in ("MALLOC_PERTURB_", "GLIBC_TUNABLES")}
        os.environ["MALLOC_PERTURB_"] = str(self._filling)
        os.environ["GLIBC_TUNABLES"] = f"glibc.malloc.perturb={self._filling}"
        self._process = context.Process(target=_serve, args=(theirs,), daemon=True)
        self._process.start()
        for name, value in kept.items():
            os.environ.pop(name) if value is None else os.environ.__setitem__(name, value)
        theirs.close()
        self._pipe = ours

    def read(self, path: Path) -> tuple[str, Any]:
        """``read`` with a digest, ``equal``…, or one of the verdicts with its text."""
        try:
            self._pipe.send(path)
            if self._pipe.poll(PATIENCE_S):
                answer: tuple[str, Any] = self._pipe.recv()
                return answer
            verdict = HANG
        except (EOFError, OSError):
            verdict = CRASH
        self.close()
        code = self._process.exitcode
        self._start()
        return verdict, f"exit code {code}"

    def close(self) -> None:
        """End the process: by itself, so that it leaves nothing behind, else killed."""
        self._pipe.close()
        self._process.join(2)
        self._process.kill()
        self._process.join(10)


def _serve(pipe: Connection) -> None:
    from core.errors import ImagechainError
    from nodes.files.formats import read_info, read_pixels

    warnings.simplefilter("ignore")  # libraries' own
    while True:
        try:
            path = pipe.recv()
        except EOFError:
            return
        try:
            info = read_info(path)
            samples = read_pixels(path)
            assert samples.shape == (info.rows, info.columns)
            answer = "read", samples
        except ImagechainError as error:
            lines = str(error).splitlines()
            answer = (REFUSED, str(error)) if len(lines) == 1 else (INTERNAL, str(error))
        except BaseException as error:
            answer = INTERNAL, f"{type(error).__name__}: {error}"
        pipe.send(answer)


def damaged(made: Made, rng: np.random.Generator) -> tuple[Made, bool]:
    """One flipped bit, some bytes overwritten, a truncation, or a mutated header text.

    The flag says whether the change lies where a checksum covers it.
    """
    content = bytearray(made.content)
    text = dict(made.beside)
    choice = rng.random()
    if made.beside and choice < (0.5 if made.store else 0.8):
        name = next(iter(text))
        mutated = _mutated_json if made.store else partial(_mutated_text, end=b"\n")
        text[name] = mutated(text[name], rng)
        return _changed(made, bytes(content), text), False
    if made.kind.startswith("fits") and choice < 0.6:
        head = _mutated_cards(bytes(content[:2880]), rng)
        return _changed(made, head + bytes(content[2880:]), text), False
    if choice < 0.85:
        places = [_place(made, rng)]
        content[places[0]] ^= 1 << int(rng.integers(8))
    elif choice < 0.95:
        places = rng.integers(0, len(content), 4).tolist()
        for place in places:
            content[place] = int(rng.integers(256))
    else:
        least = 0 if made.store else 1
        return _changed(made, bytes(content[: int(rng.integers(least, len(content)))]), text), False
    touched = [place for place in places if content[place] != made.content[place]]
    covered = all(any(a <= place < b for a, b in made.guarded) for place in touched)
    return _changed(made, bytes(content), text), bool(touched) and covered


def _place(made: Made, rng: np.random.Generator) -> int:
    """A byte anywhere; half of the time one of the first or last 400, where headers lie."""
    length = len(made.content)
    if rng.random() < 0.5:
        return int(rng.integers(length))
    near = int(rng.integers(min(400, length)))
    return near if rng.random() < 0.5 else length - 1 - near


def _changed(made: Made, content: bytes, beside: dict[str, bytes]) -> Made:
    return replace(made, content=content, beside=beside)


_VALUES = (
    b"-1", b"0", b"1", b"3", b"4", b"99999999999", b"nan", b"1.5", b"TIFF", b"", b"1e400", b"3.5D4",
    b"-32768", b"'text'", b"T", b"{1, 2", b"bsq", b"uW/cm^2/sr/um", b"photons/s/cm^2/sr/um",
)  # fmt: skip


def _mutated_text(text: bytes, rng: np.random.Generator, end: bytes) -> bytes:
    """A line lost, doubled, given another value, or one byte changed."""
    lines = text.split(end)
    place = int(rng.integers(len(lines)))
    key = lines[place].partition(b"=")[0]
    match int(rng.integers(5)):
        case 0:
            del lines[place]
        case 1:
            lines.insert(int(rng.integers(len(lines))), lines[place])
        case 2:
            lines[place] = key + b"= " + _VALUES[rng.integers(len(_VALUES))]
        case 3:
            lines.append(key + b"= " + _VALUES[rng.integers(len(_VALUES))])
        case _:
            raw = bytearray(text)
            raw[rng.integers(len(raw))] = int(rng.integers(256))
            return bytes(raw)
    return end.join(lines)


def _mutated_json(text: bytes, rng: np.random.Generator) -> bytes:
    """A number or word of the description of a store changed, or one byte of it."""
    found = list(re.finditer(rb'"[^"]*"|-?[0-9.]+|null|true|false', text))
    if rng.random() < 0.2:
        raw = bytearray(text)
        raw[rng.integers(len(raw))] = int(rng.integers(256))
        return bytes(raw)
    place = found[rng.integers(len(found))]
    other = found[rng.integers(len(found))][0]
    values = (b"0", b"-1", b"1", b"7", b"99999999999", b"1.5", b'"x"', b"null", b"[]", b"{}", other)
    return text[: place.start()] + values[rng.integers(len(values))] + text[place.end() :]


def _mutated_cards(head: bytes, rng: np.random.Generator) -> bytes:
    """Another value for a keyword, a keyword added, or a byte changed; still 2880 bytes."""
    cards = [head[at : at + 80] for at in range(0, 2880, 80)]
    last = next(at for at, card in enumerate(cards) if card.startswith(b"END "))
    value = _VALUES[rng.integers(len(_VALUES))]
    match int(rng.integers(3)):
        case 0:
            place = int(rng.integers(last))
            cards[place] = (cards[place][:8] + b"= " + value.rjust(20)).ljust(80)
        case 1:
            names = (b"BLANK", b"BZERO", b"BSCALE", b"NAXIS3", b"BUNIT", b"DATASUM", b"EXTEND")
            name = names[rng.integers(len(names))]
            cards[last + 1] = cards[last]
            cards[last] = (name.ljust(8) + b"= " + value.rjust(20)).ljust(80)
        case _:
            place = int(rng.integers((last + 1) * 80))
            return head[:place] + bytes([int(rng.integers(256))]) + head[place + 1 :]
    return b"".join(cards)


def judged(made: Made, covered: bool, readers: list[Reader], folder: Path) -> tuple[str, str]:
    """Verdict on a damaged file, and the text that goes with it."""
    shutil.rmtree(folder / f"damaged{made.store or '.zarr'}", ignore_errors=True)
    for name, content in {**made.beside, made.suffix: made.content}.items():
        file = folder / f"damaged{name}"
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    path = folder / f"damaged{made.store or made.suffix}"
    answers = [reader.read(path) for reader in readers]
    for kind, text in answers:
        if kind in FAULTS:
            return kind, str(text)
    kinds = {kind for kind, _ in answers}
    if kinds == {REFUSED}:
        return REFUSED, str(answers[0][1])
    if len(kinds) > 1 or len({_digest(samples) for _, samples in answers}) > 1:
        return DIFFERS, "refused once, read once" if len(kinds) > 1 else "other samples each time"
    samples = answers[0][1]
    same = samples.shape == made.truth.shape and np.array_equal(
        samples, made.truth.astype(samples.dtype), equal_nan=True
    )
    if same:
        return EQUAL, ""
    return (WRONG, "accepted") if covered else (UNGUARDED, "")


def _digest(samples: Any) -> str:
    return hashlib.sha256(samples.tobytes() + str(samples.shape).encode()).hexdigest()


def fuzz(
    *, count: int, seed: int, kinds: tuple[str, ...] = tuple(KINDS), keep: Path | None = None
) -> dict[str, Counter[str]]:
    """Verdicts by kind of file.

    Parameters
    ----------
    count, seed
        How many damaged files, and where the chances begin.
    kinds
        Of `KINDS`.
    keep
        Folder in which files with a verdict of `FAULTS` are kept.
    """
    shares = np.array([KINDS[kind][0] for kind in kinds])
    found: dict[str, Counter[str]] = {}
    readers = [Reader(filling) for filling in FILLINGS]
    try:
        with tempfile.TemporaryDirectory() as name:
            folder = Path(name)
            for index in range(count):
                rng = np.random.default_rng((seed, index))
                made = KINDS[str(rng.choice(kinds, p=shares / shares.sum()))][1](folder, rng)
                broken, covered = damaged(made, rng)
                verdict, text = judged(broken, covered, readers, folder)
                found.setdefault(made.kind, Counter())[verdict] += 1
                if verdict in FAULTS:
                    print(f"{seed}/{index} {made.kind}: {verdict}: {text}", flush=True)
                    if keep is not None:
                        keep.mkdir(parents=True, exist_ok=True)
                        for suffix, content in {
                            **broken.beside, broken.suffix: broken.content
                        }.items():  # fmt: skip
                            file = keep / f"{seed}-{index}{suffix}"
                            file.parent.mkdir(parents=True, exist_ok=True)
                            file.write_bytes(content)
    finally:
        for reader in readers:
            reader.close()
    return found


def table(found: dict[str, Counter[str]]) -> str:
    """Counts by kind of file and verdict."""
    total: Counter[str] = sum(found.values(), Counter())
    heads = [verdict for verdict in VERDICTS if verdict in FAULTS or total[verdict]]
    lines = ["kind".ljust(22) + "  ".join(heads)]
    for kind, counts in [*sorted(found.items()), ("all", total)]:
        cells = "  ".join(str(counts[verdict]).rjust(len(verdict)) for verdict in heads)
        lines.append(kind.ljust(22) + cells)
    return "\n".join(lines)


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--kinds", nargs="+", choices=list(KINDS), default=list(KINDS))
    parser.add_argument("--keep", type=Path, help="folder for files with a fault")
    given = parser.parse_args()
    found = fuzz(count=given.count, seed=given.seed, kinds=tuple(given.kinds), keep=given.keep)
    print(table(found))
    return 1 if any(counts[fault] for counts in found.values() for fault in FAULTS) else 0


if __name__ == "__main__":
    sys.exit(main())
