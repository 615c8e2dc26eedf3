"""Frozen dataclasses that are made in a fifth of the time: a small network uses two hundred.

Python compiles six methods for each; here `__init__` alone is compiled, and the rest is shared.
"""

import dataclasses
from dataclasses import MISSING, asdict, field, fields, is_dataclass, replace
from functools import partial
from operator import attrgetter
from reprlib import recursive_repr
from threading import RLock
from typing import TYPE_CHECKING, Any

__all__ = ["asdict", "dataclass", "field", "fields", "is_dataclass", "replace"]

_LOCK = RLock()


def _record(cls: Any = None, /, *, frozen: bool = False, eq: bool = True, **how: Any) -> Any:
    """`dataclasses.dataclass`; every field of a frozen class is a parameter."""
    if cls is None:
        return partial(_record, frozen=frozen, eq=eq, **how)
    if not frozen or how.get("order"):
        return dataclasses.dataclass(cls, frozen=frozen, eq=eq, **how)
    cls.__doc__ = cls.__doc__ or cls.__name__  # Python would take long to write a signature
    above = [vars(base).get("__dataclass_params__") for base in cls.__mro__[1:]]
    marked = [params for params in above if params and params.frozen]
    with _LOCK:
        for params in marked:  # what is not frozen could not follow a frozen class
            params.frozen = False
        try:
            dataclasses.dataclass(cls, init=False, repr=False, eq=False, **how)
            marked.append(cls.__dataclass_params__)
        finally:
            for params in marked:
                params.frozen = True
    names = [one.name for one in fields(cls) if one.compare]
    values = (
        attrgetter(*names) if len(names) > 1 else lambda self: [getattr(self, n) for n in names]
    )

    def equal(self: Any, other: Any) -> bool:
        return values(self) == values(other) if type(other) is type(self) else NotImplemented

    def first(self: Any, *given: Any, **named: Any) -> None:
        """Compiled when first called: a run uses a third of the classes that it loads."""
        made = _init(cls)
        cls.__init__ = made
        made(self, *given, **named)

    methods = {"__init__": first, "__repr__": _repr}
    if eq:
        methods |= {"__eq__": equal, "__hash__": lambda self: hash(tuple(values(self)))}
    for name, method in methods.items():
        if vars(cls).get(name) is None:
            setattr(cls, name, method)
    cls.__setattr__ = cls.__delattr__ = _frozen
    return cls


def _init(cls: Any) -> Any:
    """Sets every field as Python's own does."""
    names: dict[str, Any] = {"_put": object.__setattr__, "_left_out": MISSING}
    given, by_name, lines = ["self"], ["*"], []
    for one in fields(cls):
        name = value = one.name
        default = ""
        if one.default is not MISSING:
            names[f"_default_{name}"], default = one.default, f"=_default_{name}"
        elif one.default_factory is not MISSING:
            names[f"_default_{name}"], default = one.default_factory, "=_left_out"
            value = f"_default_{name}() if {name} is _left_out else {name}"
        (by_name if one.kw_only else given).append(name + default)
        lines.append(f"_put(self, {name!r}, {value})")
    if hasattr(cls, "__post_init__"):
        lines.append("self.__post_init__()")
    words = ", ".join([*given, *(by_name if len(by_name) > 1 else [])])
    exec(f"def __init__({words}):\n " + "\n ".join(lines or ["pass"]), names)
    names["__init__"].__qualname__ = f"{cls.__qualname__}.__init__"
    return names["__init__"]


@recursive_repr()
def _repr(self: Any) -> str:
    shown = (f"{one.name}={getattr(self, one.name)!r}" for one in fields(self) if one.repr)
    return f"{type(self).__qualname__}({', '.join(shown)})"


def _frozen(self: Any, name: str, *value: Any) -> None:
    """Fields never change; what a class that is no dataclass itself adds to one may."""
    if name in self.__dataclass_fields__ or "__dataclass_fields__" in vars(type(self)):
        what = "assign to" if value else "delete"
        raise dataclasses.FrozenInstanceError(f"cannot {what} field {name!r}")
    (object.__setattr__ if value else object.__delattr__)(self, name, *value)


if TYPE_CHECKING:
    from dataclasses import dataclass
else:
    dataclass = _record
