"""Every module as a function of its parameters: ``ic.modules.gaussian_mtf(sigma_x_mrad=0.3)``.

Modules of another installed package are under its name: ``ic.modules.acme_optics.glare_mtf()``.
"""

from __future__ import annotations

from collections.abc import Callable

from imagechain.parts.module_functions import (
    PackageModules,
    module_function,
    module_names,
    package_names,
)
from imagechain.parts.module_part import Part


def __getattr__(name: str) -> Callable[..., Part] | PackageModules:
    named = PackageModules(name) if name in package_names() else module_function(name)
    globals()[name] = named
    return named


def __dir__() -> list[str]:
    return module_names()
