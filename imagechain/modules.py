"""Every module as a function of its parameters: ``ic.modules.gaussian_mtf(sigma_x_mrad=0.3)``."""

from __future__ import annotations

from collections.abc import Callable

from imagechain.parts.module_functions import module_function, module_names
from imagechain.parts.module_part import Part


def __getattr__(name: str) -> Callable[..., Part]:
    function = module_function(name)
    globals()[name] = function
    return function


def __dir__() -> list[str]:
    return module_names()
