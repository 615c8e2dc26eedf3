"""Cut picture files short while they are read: refused or read, never the end of the process.

``python tests/fuzz/shrinking_files.py --count 300 --seed 1`` prints how each of the readings ended,
and ends with 1 where one ended otherwise than with samples or the reader's own error. A signal such
as SIGBUS ends the command itself.
"""

import argparse
import os
import sys
import tempfile
import threading
import time
from collections import Counter
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT)]

from core.errors import FileError  # noqa: E402
from nodes.files.formats import read_pixels  # noqa: E402
from nodes.files.frames import open_frames  # noqa: E402
from nodes.files.pictures import write_by_oiio  # noqa: E402
from nodes.optics.mtf_file import stored_samples  # noqa: E402

LONGEST_WAIT_S = 0.012
SHAPE = 1024, 1024


def main() -> int:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    rng = np.random.default_rng(given.seed)
    ends: Counter[str] = Counter()
    with tempfile.TemporaryDirectory() as folder:
        files = _files(Path(folder), rng)
        contents = [file.read_bytes() for file in files]
        for number in range(given.count):
            place = number % len(files)
            end = _shrunk(files[place], contents[place], rng)
            ends[f"{files[place].name}: {end}"] += 1
    for line, count in sorted(ends.items()):
        print(f"{line} {count}")
    return 1 if any("INTERNAL" in line for line in ends) else 0


def _files(folder: Path, rng: np.random.Generator) -> list[Path]:
    samples = rng.random(SHAPE).astype(np.float32)
    np.save(folder / "plain.npy", samples)
    np.save(folder / "columns.npy", np.asfortranarray(samples))
    np.save(folder / "complex.npy", samples.astype(np.complex64))
    np.save(folder / "frames.npy", samples.reshape(16, 64, 1024))
    write_by_oiio(folder / "deflate.tif", samples[:, :, None], {})
    levels = (255 * samples[:, :, None]).astype(np.uint8)
    write_by_oiio(folder / "a.png", levels, {})
    (folder / "cube.img").write_bytes(samples.tobytes())
    (folder / "cube.img.hdr").write_text(
        "ENVI\nsamples = 1024\nlines = 1024\nbands = 1\ndata type = 4\ninterleave = bsq\n"
        "byte order = 0\n"
    )
    return sorted(file for file in folder.iterdir() if file.suffix != ".hdr")


def _shrunk(file: Path, content: bytes, rng: np.random.Generator) -> str:
    """How the reading of a file ended that was cut short meanwhile."""
    file.write_bytes(content)
    ends: list[str] = []

    def read() -> None:
        try:
            if file.stem == "frames":
                for _ in open_frames(file).each():
                    pass
            elif file.stem == "complex":
                stored_samples(file=file, stamps=(), band=0)
            else:
                read_pixels(file)
            ends.append("read")
        except FileError as error:
            ends.append("refused" if "\n" not in str(error) else "INTERNAL: several lines")
        except BaseException as error:
            ends.append(f"INTERNAL: {type(error).__name__}: {error}")

    reader = threading.Thread(target=read)
    reader.start()
    time.sleep(rng.random() ** 3 * LONGEST_WAIT_S)
    os.truncate(file, int(rng.integers(len(content))))
    reader.join()
    return ends[0]


if __name__ == "__main__":
    sys.exit(main())
