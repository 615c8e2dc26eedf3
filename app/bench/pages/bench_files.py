"""The files that a benchmark writes: figures, a page, Markdown and pictures."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from app.bench.measuring.bench_settings import TABLES, Settings
from app.bench.measuring.bench_tables import Table
from app.bench.pages.markdown import fragment, inserted
from app.options.command_options import Options
from app.run.readout_tables import jsonable
from app.run.staging import Staging
from core.atomic import write_text

Facts = dict[str, Any]
Parts = Mapping[str, Sequence[Table]]


@dataclass(frozen=True)
class Files:
    """Where each is to go, None for those not to be written.

    Parameters
    ----------
    json, html, markdown : Path or None
        Files.
    pictures : Path or None
        A folder, made if there is none.
    tables : tuple of str
        Names of the tables that will be measured.
    """

    json: Path | None
    html: Path | None
    markdown: Path | None
    pictures: Path | None
    tables: tuple[str, ...]

    @classmethod
    def of(cls, options: Options, settings: Settings) -> Files:
        """The files of the command line."""
        return cls(
            options.bench_json,
            options.bench_html,
            options.bench_markdown,
            options.bench_pictures,
            tuple(name for part in settings.parts for name in TABLES[part]),
        )

    def named(self) -> list[Path]:
        """The files to be written, as they were named."""
        return [path for path in (self.json, self.html, self.markdown, self.pictures) if path]

    def staging(self) -> Staging:
        """A place for them, every one claimed.

        Raises
        ------
        ImagechainError
            If one cannot be written.
        """
        files = [path for path in (self.json, self.html, self.markdown) if path is not None]
        # Its folder is the one that may be missing: without pictures none, so a file stands for it.
        staging = Staging(self.pictures or (files[0] if files else Path()))
        for path in files:
            staging.claim(path)
        if self.markdown is not None:
            inserted(self.markdown, "")
        if self.pictures is not None:
            for name in self.tables:
                staging.claim(self._picture(self.pictures, name))
        return staging

    def write(self, staging: Staging, facts: Facts, parts: Parts, settings: Settings) -> None:
        """Stage them all."""
        if self.json is not None:
            text = json.dumps(jsonable(facts), indent=1, ensure_ascii=False, allow_nan=False)
            _stage(staging, self.json, text + "\n")
        if self.html is not None:
            from app.bench.pages.bench_page import page

            _stage(staging, self.html, page(facts, parts))
        if self.markdown is not None:
            text = inserted(self.markdown, fragment(facts, parts, settings))
            _stage(staging, self.markdown, text)
        if self.pictures is not None:
            from app.bench.pages.charts import chart_png

            for table in (table for tables in parts.values() for table in tables):
                drawn = chart_png(table)
                if drawn is not None:
                    target = self._picture(self.pictures, table.name)
                    staging.write(target, partial(_write_bytes, content=drawn))

    @staticmethod
    def _picture(folder: Path, name: str) -> Path:
        return folder / f"bench_{name}.png"


def _stage(staging: Staging, target: Path, text: str) -> None:
    staging.write(target, lambda path: write_text(path, text))


def _write_bytes(path: Path, content: bytes) -> None:
    path.write_bytes(content)
