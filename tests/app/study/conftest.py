import csv
import io

import pytest

from tradeoff_network import DOCUMENT


@pytest.fixture
def sensor(write):
    return write(DOCUMENT)


@pytest.fixture
def rows_of(tmp_path):
    """The rows of a study's CSV, without what they took."""

    def read(name):
        text = (tmp_path / name).read_text(encoding="utf-8")
        rows = list(csv.DictReader(io.StringIO(text)))
        for row in rows:
            assert float(row.pop("seconds (s)")) >= 0
        return rows

    return read
