"""Every module as a function of its parameters: ``ic.modules.gaussian_mtf(sigma_x_mrad=0.3)``.

Modules of another installed package are under the name of that package:
``ic.modules.acme_optics.glare_mtf()``.
"""

from collections.abc import Callable

from core.modules.declaration import local_key, package_of
from imagechain.parts.module_part import Part, module_function
from nodes.library import standard_library


class PackageModules:
    """The modules of an installed package, by name."""

    def __init__(self, package: str) -> None:
        self._package = package

    def __getattr__(self, name: str) -> Callable[..., Part]:
        function = module_function(f"{self._package}.{name}")
        vars(self)[name] = function
        return function

    def __dir__(self) -> list[str]:
        names = (key for key in standard_library() if package_of(key) == self._package)
        return sorted(map(local_key, names))


def __getattr__(name: str) -> Callable[..., Part] | PackageModules:
    is_package = any(package_of(key) == name for key in standard_library())
    named = PackageModules(name) if is_package else module_function(name)
    globals()[name] = named
    return named


def __dir__() -> list[str]:
    return sorted({package_of(key) or key for key in standard_library()})
