"""What a parameter is where nobody sets it, as plain data."""

from typing import Any

from core.modules.declaration import declaration
from core.modules.parameters import plain
from nodes.library import standard_library

DEFAULTS: dict[str, dict[str, Any]] = {
    key: {p.name: plain(p.default) for p in declaration(module).parameters if not p.required}
    for key, module in standard_library().items()
}
