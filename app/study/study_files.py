"""The rows of a study as a file: CSV, Parquet or netCDF."""

from __future__ import annotations

import importlib.util
import io
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from core.atomic import atomic_file, write_bytes, write_text
from core.errors import UsageError, how_to_install
from core.names import printable
from nodes.files.common.file_format import NETCDF, PARQUET
from nodes.files.common.table_cells import csv_lines

_NEEDED = {PARQUET: ("pyarrow",), NETCDF: ("xarray", "h5netcdf", "h5py")}


@dataclass(frozen=True)
class Column:
    """A column of the rows.

    Parameters
    ----------
    name, unit : str
        Its head.
    values : sequence
        Numbers, truth values, texts or None.
    """

    name: str
    unit: str
    values: Sequence[Any]

    @property
    def head(self) -> str:
        """The name with its unit."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    @property
    def kind(self) -> type:
        """The type that all values have, but for None; text where they differ."""
        kinds = {type(value) for value in self.values if value is not None}
        if kinds <= {int, float} and kinds:
            return float if float in kinds else int
        return kinds.pop() if len(kinds) == 1 else (str if kinds else float)

    @property
    def typed(self) -> list[Any]:
        """The values in that type."""
        kind = self.kind
        make = _text if kind is str else kind
        return [None if value is None else make(value) for value in self.values]


def check_installed(path: Path) -> None:
    """Refuse a format whose packages are not there.

    Raises
    ------
    UsageError
        Naming the extra that brings them.
    """
    for file_format, packages in _NEEDED.items():
        missing = [name for name in packages if importlib.util.find_spec(name) is None]
        if file_format.matches(path) and missing:
            raise UsageError(
                f"--output {path}: {path.suffix} needs {' and '.join(missing)}: "
                f"{how_to_install('study')}; .csv needs nothing"
            )


def write_columns(columns: Sequence[Column], path: Path, title: str) -> None:
    """Write columns in the format of the path's suffix: the whole file, or none.

    Raises
    ------
    FileError
        If it cannot be written.
    """
    if PARQUET.matches(path):
        _write_parquet(columns, path, title)
    elif NETCDF.matches(path):
        _write_netcdf(columns, path, title)
    else:
        write_text(path, printable(csv_of(columns)))


def csv_of(columns: Sequence[Column]) -> str:
    """The columns with a line of names and units on top; what is not there is empty."""
    heads = [column.head for column in columns]
    return csv_lines([heads, *zip(*(map(_text, column.values) for column in columns), strict=True)])


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)


def _write_parquet(columns: Sequence[Column], path: Path, title: str) -> None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    kinds = {int: pa.int64(), float: pa.float64(), bool: pa.bool_(), str: pa.string()}
    fields = [
        pa.field(c.head, kinds[c.kind], metadata={"unit": c.unit} if c.unit else None)
        for c in columns
    ]
    schema = pa.schema(fields, metadata={"title": title})
    arrays = [pa.array(c.typed, kinds[c.kind]) for c in columns]
    with atomic_file(path) as temporary:
        pq.write_table(pa.Table.from_arrays(arrays, schema=schema), temporary)


def _write_netcdf(columns: Sequence[Column], path: Path, title: str) -> None:
    import xarray as xr

    variables = {}
    for column in columns:
        attributes = {"units": column.unit} if column.unit else {}
        # netCDF has no slash in names; that of a macro's inner node becomes a colon.
        name = column.name.replace("/", ":")
        variables[name] = ("row", _array(column), attributes)
    data = xr.Dataset(variables, attrs={"title": title})
    content = io.BytesIO()  # HDF5 ends the whole process where a file of its own cannot be written
    data.to_netcdf(content, engine="h5netcdf")
    write_bytes(path, content.getvalue())


def _array(column: Column) -> Any:
    kind = column.kind
    if kind is str:
        return np.array(["" if v is None else v for v in column.typed], dtype=object)
    if kind is bool and None not in column.values:
        return np.array(column.values, dtype=bool)
    if kind is int and None not in column.values:
        return np.array(column.values, dtype=np.int64)
    return np.array([math.nan if v is None else float(v) for v in column.values])
