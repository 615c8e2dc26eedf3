"""Transforms, special functions and roots of SciPy, straight from its compiled modules.

`import scipy.fft` or `scipy.special` first loads 250 modules that no transform needs, in the time
of a third of a small network's run. With a SciPy that was not checked, where it keeps a function
elsewhere, and for arguments out of the ordinary, the public function answers: the same code, and
so the same bits.
"""

import re
from collections.abc import Callable
from functools import cache, partial
from importlib import import_module
from importlib.machinery import PathFinder
from importlib.util import find_spec, module_from_spec
from pathlib import Path
from threading import Lock
from typing import Any

import numpy as np

from core.arrays import Array

# Minor versions whose modules were compared with the public functions; 1.15 does not bear a second
# copy of its modules in one process.
CHECKED = ("1.16.", "1.17.")
_LOADING = Lock()


@cache
def _compiled(folder: str, name: str) -> Any:
    with _LOADING:  # of two threads that load one at once, one is left with an empty one
        return _loaded(folder, name)


@cache
def _loaded(folder: str, name: str) -> Any:
    """A compiled module of SciPy under a name of ours, or None where none loads."""
    try:
        place = next(iter(find_spec("scipy").submodule_search_locations))  # type: ignore[arg-type,union-attr]
        version = re.search(r'^version = "(.*)"', Path(place, "version.py").read_text(), re.M)
        if version is None or not version[1].startswith(CHECKED):
            return None
        within = [f"{place}/{folder}"]
        spec = PathFinder.find_spec(f"{__name__}.{name}", within)
        module = module_from_spec(spec)  # type: ignore[arg-type]
        spec.loader.exec_module(module)  # type: ignore[union-attr]
    except (ImportError, AttributeError, ValueError, OSError):
        return None
    return module


@cache
def special(name: str) -> Any:
    """The function of scipy.special with this name."""
    found = getattr(_compiled("special", "_special_ufuncs"), name, None)
    return found or getattr(import_module("scipy.special"), name)


@cache
def sparse(name: str) -> Any:
    """The function of SciPy's sparse matrices with this name, which fills what it is given."""
    found = getattr(_compiled("sparse", "_sparsetools"), name, None)
    return found or getattr(import_module("scipy.sparse._sparsetools"), name)


def brentq(
    function: Callable[[float], float], low: float, high: float, *, xtol: float, rtol: float
) -> float:
    """A zero between two places of opposite signs; after 200 steps the best place so far."""
    found = getattr(_compiled("optimize", "_zeros"), "_brentq", None)
    found = found or import_module("scipy.optimize._zeros")._brentq
    return float(found(function, low, high, xtol, rtol, 200, (), False, False))


NORMS = {None: 0, "backward": 0, "ortho": 1, "forward": 2}  # the kernel's numbers for them


def _transform(name: str, samples: Any, size: Any = None, **how: Any) -> Array:
    """A transform of scipy.fft with its arguments; cosines and sines are of the second type."""
    x, kind, forward = np.asarray(samples), name.strip("i2n"), name[0] != "i"
    size = how.pop("n", how.pop("s", size))
    axes = (0, 1) if name[-1] in "2n" else (how.get("axis", -1),)
    half = kind == "rfft" and not forward
    sizes = list(np.atleast_1d(size)) if size is not None else [x.shape[axis] for axis in axes]
    if half and size is None:
        sizes[-1] = 2 * sizes[-1] - 2
    last = int(sizes[-1])
    given = [*sizes[:-1], last // 2 + 1] if half else sizes
    kernel = _compiled("fft/_pocketfft", "pypocketfft")
    if (
        kernel is None
        or how.get("type", 2) != 2
        or x.dtype.char not in ("FD" if half else "fdFD" if kind == "fft" else "fd")
        or not (x.size and last and x.flags.aligned and x.dtype.isnative)
        or len(axes) not in (1, x.ndim)
        or [x.shape[axis] for axis in axes] != given
    ):
        how["s" if len(axes) > 1 else "n"] = size
        return np.asarray(getattr(import_module("scipy.fft"), name)(samples, **how))
    norm, workers = NORMS[how.get("norm")], how.get("workers") or 1
    norm = norm if forward else 2 - norm
    out = x if how.get("overwrite_x") and x.dtype.kind == ("c" if kind == "fft" else "f") else None
    if kind in ("dct", "dst"):
        made = getattr(kernel, kind)(x, 2 if forward else 3, axes, norm, out, workers, None)
    elif half:
        made = kernel.c2r(x, axes, last, False, norm, None, workers)
    elif kind == "rfft":
        made = kernel.r2c(x, axes, True, norm, None, workers)
    else:
        made = kernel.c2c(x, axes, forward, norm, out, workers)
    return np.asarray(made)


def next_fast_len(size: int, real: bool = False) -> int:
    """The least size from `size` on that transforms fast."""
    kernel = _compiled("fft/_pocketfft", "pypocketfft")
    found = kernel.good_size if kernel else import_module("scipy.fft").next_fast_len
    return int(found(size, real))


fft, ifft, rfft, irfft = (partial(_transform, name) for name in ("fft", "ifft", "rfft", "irfft"))
fft2, ifft2, rfft2, irfft2 = (
    partial(_transform, name) for name in ("fft2", "ifft2", "rfft2", "irfft2")
)
dct, idct, dst, idst = (partial(_transform, name) for name in ("dct", "idct", "dst", "idst"))
dctn = partial(_transform, "dctn")
