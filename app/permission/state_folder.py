"""Where this user's programs keep their state: never inside a network's folder."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path


def state_folder(
    environment: Mapping[str, str] | None = None, platform: str = sys.platform
) -> Path | None:
    """The folder of this program's own records; None where the user has no folder at all.

    ``$XDG_STATE_HOME/imagechain`` where that is set, else the system's usual place.
    """
    known = os.environ if environment is None else environment
    given = known.get("XDG_STATE_HOME", "")
    if Path(given).is_absolute():
        return Path(given) / "imagechain"
    if platform == "win32":
        local = known.get("LOCALAPPDATA", "")
        return Path(local) / "imagechain" if local else None
    home = known.get("HOME", "")
    if not Path(home).is_absolute():
        return None
    if platform == "darwin":
        return Path(home) / "Library" / "Application Support" / "imagechain"
    return Path(home) / ".local" / "state" / "imagechain"
