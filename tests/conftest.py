"""Assertions in shared helpers explain themselves as those of tests do."""

from pathlib import Path

import pytest

SUPPORT = Path(__file__).parent / "support"

pytest.register_assert_rewrite(*sorted(path.stem for path in SUPPORT.glob("*.py")))
