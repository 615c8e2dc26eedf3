"""Every module as a function of its parameters: ``ic.modules.gaussian_mtf(sigma_x_mrad=0.3)``.

Modules of another installed package are under the name of that package:
``ic.modules.acme_optics.glare_mtf()``.
"""

from collections.abc import Callable
from functools import cache
from types import ModuleType

from core.modules.declaration import local_key, package_of
from imagechain.parts.module_part import Part, module_function
from nodes.library import standard_library


def _package(name: str, keys: list[str]) -> ModuleType:
    """The modules of an installed package, by name."""
    made = ModuleType(f"{__name__}.{name}")
    function = cache(lambda module: module_function(f"{name}.{module}"))
    vars(made).update(__getattr__=function, __dir__=lambda: sorted(map(local_key, keys)))
    return made


def __getattr__(name: str) -> Callable[..., Part] | ModuleType:
    keys = [key for key in standard_library() if package_of(key) == name]
    named = _package(name, keys) if keys else module_function(name)
    globals()[name] = named
    return named


def __dir__() -> list[str]:
    return sorted({package_of(key) or key for key in standard_library()})
