"""Where this user's programs keep settings, records, unsaved work, and what can be made again."""

from pathlib import Path

import platformdirs

_NAME = "imagechain"


def settings_folder() -> Path:
    """Look and windows of the editor."""
    return platformdirs.user_config_path(_NAME, appauthor=False)


def data_folder() -> Path:
    """Work that no file holds yet."""
    return platformdirs.user_data_path(_NAME, appauthor=False)


def state_folder() -> Path:
    """What networks have written; never inside a network's folder."""
    return platformdirs.user_state_path(_NAME, appauthor=False)


def cache_folder() -> Path:
    return platformdirs.user_cache_path(_NAME, appauthor=False)
