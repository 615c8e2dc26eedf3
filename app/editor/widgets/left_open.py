"""Methods that a base class of widgets leaves to the classes made of it.

A widget's metaclass is Qt's own, so that `abc` cannot enforce it.
"""

from __future__ import annotations


def require_defined(kind: type, base: type, *names: str) -> None:
    """Refuse a class that leaves open what its base does.

    Raises
    ------
    TypeError
        Naming class and method, when a widget of that class is made.
    """
    for name in names:
        if getattr(kind, name) is getattr(base, name):
            raise TypeError(f"{kind.__name__} does not define {name}, which {base.__name__} needs")
