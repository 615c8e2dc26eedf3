"""Load `core`, `nodes`, `app` and `networks`, even if other packages have the same names.

The code imports these packages by their plain names, but Python searches the folder of the user's
script first. The four packages are therefore loaded from the folder of `imagechain` before anything
else. Import only the standard library in this file.
"""

import os
import sys
import warnings
from collections.abc import Iterable
from importlib.machinery import PathFinder
from importlib.util import module_from_spec, spec_from_file_location
from itertools import takewhile
from pathlib import Path
from types import ModuleType

NAMES = ("core", "nodes", "app", "networks")


def load_own_packages(root: Path) -> None:
    """Load the four packages from `root`, the folder that contains `imagechain`.

    Warns if a folder or file with the name of one of the four packages would have been found first
    and is now hidden. The command does not warn, because it imports none of the user's code; child
    processes do not warn either.
    """
    others = [name for name in NAMES if not _is_own(sys.modules.get(name), root)]
    taken = [name for name in others if name in sys.modules]
    if taken:
        where = "; ".join(f"{name} from {_place(sys.modules[name])}" for name in taken)
        raise ImportError(
            "imagechain cannot be imported: a package with the same name as a package of "
            f"imagechain is already imported ({where}). Rename that package, or import imagechain "
            "first",
            name="imagechain",
        )
    hidden = [place for name in others for place in _in_front(name, root)]
    for name in others:
        _load(name, root)
    if hidden and not _is_command_or_child():
        what = "them" if len(hidden) > 1 else "it"
        warnings.warn(
            f"{', '.join(hidden)} cannot be imported together with imagechain, which has a package "
            f"of the same name: rename {what}",
            UserWarning,
            stacklevel=3,
        )


def _is_command_or_child() -> bool:
    program = sys.argv[0] if sys.argv else ""  # "-m" while Python looks for what it names
    is_child = any("multiprocessing" in word for word in sys.orig_argv[1:])
    return program == "-m" or Path(program).stem == "imagechain" or is_child


def _is_own(module: ModuleType | None, root: Path) -> bool:
    path = getattr(module, "__path__", None) or ()
    return any(_same(Path(place), root / getattr(module, "__name__", "")) for place in path)


def _load(name: str, root: Path) -> None:
    file = root / name / "__init__.py"
    spec = spec_from_file_location(name, file, submodule_search_locations=[str(file.parent)])
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise


def _in_front(name: str, root: Path) -> Iterable[str]:
    """What Python would have imported by that name from a folder it searches before ours."""
    for entry in takewhile(lambda entry: not _same(Path(entry), root), sys.path):
        found = PathFinder.find_spec(name, [entry])
        if found is not None:
            place = next(iter(found.submodule_search_locations or ()), found.origin or "")
            if found.origin or any(Path(place).glob("*.py")):  # a folder of modules, or none
                yield place
                return


def _same(one: Path, other: Path) -> bool:
    try:
        return os.path.realpath(one) == os.path.realpath(other)
    except OSError:  # the current folder has been removed
        return False


def _place(module: ModuleType) -> str:
    path = getattr(module, "__path__", None)
    return str(getattr(module, "__file__", None) or next(iter(path or ()), "nowhere"))
