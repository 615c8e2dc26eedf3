"""Carrying out the job of a background run: all of its files appear at the end, or none."""

import json
import threading
import time
from functools import partial
from pathlib import Path, PurePath
from typing import Any

import numpy as np

from app.command.network_run import KEPT_BYTES, NetworkRun
from app.command.options import write_content
from app.run import option_values, overrides, saving, shipped, terminal, transfer_chain
from app.run.evaluation import Evaluation, TimedWork, each_readout, planned
from app.run.job import FRAMES, REPORT, Job, Result, Steps
from app.run.staging import Staging, WriteRecord, WriteRules, check_folder, read_record, real_target
from app.study.study_drawing import trade_off_content
from app.study.study_rows import Column, csv_of
from app.tradeoff.tradeoff_results import default_figures, shown_value, trade_off
from core.atomic import write_text
from core.chain.engine import Engine, realize
from core.errors import InputError, UsageError, printable
from core.evaluation.recipes import Store
from core.evaluation.work import Policy
from core.modules.declaration import Library, declaration
from core.network.file import parse_network
from core.network.network import Network
from core.network.validation import plain_network
from core.records import replace
from nodes.library import standard_library

UNSAVED = "unsaved network"
TRADE_OFF_PAGE, TRADE_OFF_TABLE, READOUT_TABLE = "tradeoff.html", "tradeoff.csv", "readouts.csv"
MOST_PREVIEWS, PREVIEW_PX = 24, 256
_POLICY = Policy()
_FIGURES = 0.2  # of what a picture takes, at the same value
_HOW_TO_ALLOW = (
    "choose the file with Browse… on the node's control panel, or choose another output folder"
)


def carry_out(job: Job, cancel: threading.Event | None, steps: Steps) -> Result:
    library = standard_library()
    document = parse_network(job.network, library=library, name_of_source=str(_path(job)))
    network = plain_network(document, library=library)
    return _Runs(replace(job, output=job.output.absolute()), network, cancel, steps).made()


def _path(job: Job) -> Path:
    return job.path if job.path is not None else job.folder / UNSAVED


class _Runs:
    def __init__(
        self, job: Job, network: Network, cancel: threading.Event | None, steps: Steps
    ) -> None:
        self._job, self._network, self._cancel, self._steps = job, network, cancel, steps
        self._place = shipped.Place(_path(job), _path(job).stem)
        reported = job.report or job.kind == "report"
        self._engine = Engine(standard_library(), None if reported else Store(KEPT_BYTES))
        self._rules = self._write_rules()
        self._errors: dict[str, InputError] = {}
        self._warnings: list[str] = []
        self._previews: dict[str, bytes] = {}
        self._figures: dict[str, dict[str, float]] = {}

    def made(self) -> Result:
        job, variants = self._job, self._job.variants
        alone = job.kind == "report"
        if not alone:
            check_folder(job.output)
        figures = 0.0 if job.kind != "sweep" else _FIGURES if variants else 1.0
        self._steps.expect(len(variants) + alone + job.frames + figures * len(job.values))
        chosen = [self._place.folder / file for file in job.values if job.kind == "files"]
        with Staging(None if alone else job.output, [self._place.path, *chosen]) as staging:
            for name, value in variants:
                try:
                    self._run(name, value, staging)
                except InputError as error:
                    if not name:
                        raise
                    staging.drop(job.output / name)
                    self._previews.pop(name, None)
                    self._errors[name] = error
            if variants and len(self._errors) == len(variants):
                raise next(iter(self._errors.values()))
            page = self._trade_off(staging, figures)
            if job.kind == "files":
                rows = self._figures.values()
                columns = [Column("run", "", [*self._figures])]
                for figure in dict.fromkeys(figure for row in rows for figure in row):
                    columns.append(Column(figure, "", [row.get(figure) for row in rows]))
                table = printable(csv_of(columns))
                staging.write(job.output / READOUT_TABLE, partial(write_text, content=table))
            self._work().check()
            terminal.too_late(self._cancel)
            if job.path is None:  # there is no network to record it of
                staging.commit()
            elif forgotten := self._rules.commit(staging):
                self._warnings.append(
                    f"could not record the written files for the next run: {forgotten}"
                )
        if page is None and (alone or (job.report and not variants[0][0])):
            page = job.output if alone else job.output / REPORT
        failures = tuple((name, str(error)) for name, error in self._errors.items())
        told = tuple(self._warnings), page, tuple(self._previews.items())
        return Result(max(1, len(variants)), failures, *told)

    def _run(self, name: str, value: Any, staging: Staging) -> None:
        start, job, library = time.perf_counter(), self._job, self._engine.library
        alone = job.kind == "report"
        folder = job.output.parent if alone else job.output / name
        network = self._with()
        if name:
            node, _, parameter = job.target.rpartition(".")
            # The window's file names are relative to the network, not to this process.
            given = str(self._place.folder / value) if job.kind == "files" else value
            network = self._with((option_values.Assignment(node, parameter, json.dumps(given)),))
            network = _writing_to(network, library, folder)
        plan = planned(self._engine, network, self._place.folder)
        saves: tuple[option_values.Save, ...] = ()
        if job.frames:
            port = transfer_chain.find_output(plan)
            if port.port is None:
                raise UsageError(
                    f"{port.missing}: press O on the node whose picture you want as frames"
                )
            node, _, picture = port.port.rpartition(".")
            saves = (option_values.Save(node, picture, str(folder / FRAMES)),)
        self._steps.part(name, nodes=len(plan.nodes))
        reports = (job.output,) if alone else (folder / REPORT,) if job.report else ()
        evaluation = NetworkRun(
            self._engine, plan, self._work(), folder, staging, self._rules, only_report=alone,
            saves=saves, frames=job.frames or None, reports=reports, frame_done=self._frame_done,
            look=partial(self._look, name),
        ).prepare(start=start).evaluation  # fmt: skip
        lines = terminal.warning_lines(evaluation.cautions)
        self._warnings += [f"{name}: {line}" if name else line for line in lines]
        self._figures[name] = {
            f"{row.node}.{row.name}": row.value
            for row in each_readout(evaluation)
            if overrides.is_number(row.value)
        }

    def _look(self, name: str, evaluation: Evaluation) -> None:
        if len(self._previews) < MOST_PREVIEWS and evaluation.chain.final is not None:
            samples = realize(evaluation.plan.output(evaluation.chain.final), evaluation.work)
            step = max(1, -(-max(samples.shape) // PREVIEW_PX))
            few = np.ascontiguousarray(samples[::step, ::step])
            self._previews[name] = saving.grey_png(few, saving.robust_limits(samples))
        if self._job.kind == "report":
            self._steps.part("writing the report")

    def _trade_off(self, staging: Staging, weight: float) -> Path | None:
        job = self._job
        if job.kind != "sweep":
            return None
        network, library = self._with(), self._engine.library
        node, _, name = job.target.rpartition(".")
        setting = option_values.Assignment(node, name, "")
        parameter = overrides.named_parameter("sweep", setting, network, library=library)
        assert parameter is not None  # the network has been checked
        varied = overrides.Variation(node, parameter, job.values, job.log)
        plan = self._engine.plan(network, folder=self._place.folder)
        shown = [f"{varied.text} = {shown_value(value, varied.unit)}" for value in job.values]

        def reach(count: int) -> None:
            if count < len(shown):
                doing = f"figures at {shown[count]}"
                self._steps.part(doing, nodes=len(plan.nodes), weight=weight)

        reach(0)
        results = trade_off(
            self._engine, plan, self._work(), (varied,), default_figures(network, library),
            name=network.name or self._place.name, by_default=True, reached=reach,
        )  # fmt: skip
        if (why := results.why_nothing()) is not None:
            if job.pictures:
                return None  # there are the pictures
            raise UsageError(f"no value of {varied.text} gives a figure{why and f': {why}'}")
        for file in (TRADE_OFF_PAGE, TRADE_OFF_TABLE):
            content = trade_off_content(results, Path(file))
            staging.write(job.output / file, partial(write_content, content=content))
        return job.output / TRADE_OFF_PAGE

    def _with(self, settings: tuple[option_values.Assignment, ...] = ()) -> Network:
        asked = overrides.GivenNetwork(self._place, settings)
        return asked.changed(self._network, self._engine.library)[0]

    def _work(self) -> TimedWork:
        return TimedWork(_POLICY, self._engine.store, self._cancel, self._steps.node)

    def _write_rules(self) -> WriteRules:
        job, path = self._job, self._place.path
        record = WriteRecord(path) if job.path is None else read_record(path)
        output = real_target(job.output)
        own = () if job.path is None else (real_target(self._place.folder),)
        return WriteRules(
            folders=(*own, output),
            allowed=(output,) if job.kind in ("sweep", "files") else (),  # no node names the file
            given=frozenset(),
            record=replace(record, chosen=record.chosen | {*map(real_target, job.chosen)}),
            how_to_allow=_HOW_TO_ALLOW,
        )

    def _frame_done(self, number: int) -> None:
        if number == 1:
            self._steps.part("frames", weight=self._job.frames)
        self._steps.piece(number, self._job.frames)


def _writing_to(network: Network, library: Library, folder: Path) -> Network:
    for node in network.nodes.values():
        path = node.params.get("path")
        sink = node.module in library and declaration(library[node.module]).sink
        if sink and isinstance(path, str) and path:
            network = network.with_parameter(node.id, "path", str(folder / PurePath(path).name))
    return network
