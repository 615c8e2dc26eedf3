"""A parameter of the module, else of Init & Trans, else an error that names both."""

from __future__ import annotations

from core.errors import ParameterError
from core.values import Context


def given(name: str, own: float | None, context: Context, *, unit: str) -> float:
    """The module's own value, else the context's of the same name.

    Raises
    ------
    ParameterError
        If neither is given.
    """
    value = own if own is not None else getattr(context, name)
    if value is None:
        raise ParameterError(name, None, "give it here or on Init & Trans", unit=unit)
    return float(value)
