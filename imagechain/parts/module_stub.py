"""The stub of `imagechain.modules`, for editors and type checkers."""

import sys
from pathlib import Path

from core.atomic import write_text
from core.modules.declaration import Declaration, Library, declaration
from imagechain.parts.module_part import annotation, default, documentation
from nodes.library import standard_library

STUB = Path(__file__).resolve().parents[1] / "modules.pyi"
_HEAD = '''"""Every module as a function of its parameters.

Made by ``python -m imagechain.parts.module_stub``.
"""

from collections.abc import Sequence
from os import PathLike
from typing import Literal

from imagechain.parts.module_part import Expression, Part
'''


def stub_text(library: Library) -> str:
    """The text of the stub."""
    functions = [_function(declaration(module)) for module in library.values()]
    return "\n".join([_HEAD, *functions])


def _function(declared: Declaration) -> str:
    lines = [f"def {declared.key}("]
    if declared.parameters:
        lines.append("    *,")
        lines += [
            f"    {p.name}: {annotation(p)[1]} = {default(p)!r}," for p in declared.parameters
        ]
    text = documentation(declared).replace("\\", "\\\\").replace('"""', "'''")
    body = [f"    {line}".rstrip() for line in text.splitlines()]
    lines += [") -> Part:", '    """' + body[0].lstrip(), *body[1:], '    """', ""]
    return "\n".join(lines)


def main() -> int:
    """Write the stub of the current library."""
    write_text(STUB, stub_text(standard_library()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
