"""Write the files of a chain's write nodes, all or none."""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable
from dataclasses import replace
from functools import partial
from os import PathLike, fspath
from pathlib import Path

from app.command.run import input_files, sink_files, sink_targets
from app.run.evaluation import Evaluation
from app.run.staging import Staging
from app.run.write_rules import WriteRules, read_record
from imagechain.results.run_options import Origin


def write_files(
    evaluation: Evaluation, origin: Origin, allowed: Iterable[str | PathLike[str]]
) -> list[Path]:
    """Write the files of write nodes; returns their paths.

    Raises
    ------
    FileError
        If a file cannot be written, or a network from a file names one outside its own folder or
        one that it has not written itself.
    """
    plan = evaluation.plan
    folder = plan.folder
    targets = sink_targets(plan, folder)
    file = origin.file if origin.file is not None else folder / "chain without a file.json"
    rules = WriteRules(
        folders=(Path(os.path.realpath(folder)),),
        allowed=tuple(Path(os.path.realpath(fspath(one))) for one in allowed),
        given=origin.given,
        record=read_record(file),
    )
    inputs = [file, *input_files(plan, folder)]
    with Staging(None, inputs) as staging:
        for node, path in targets.items():
            where = shlex.quote(os.path.dirname(os.path.realpath(path)))  # noqa: PTH120
            told = replace(rules, how_to_allow=f"write_files(allow=[{where}]) allows it")
            staging.claim(path, partial(told.check, node))
        for _, path, writer in sink_files(evaluation):
            staging.write(path, writer)
        if origin.file is None:
            staging.commit()
        else:
            rules.commit(staging)
    return list(targets.values())
