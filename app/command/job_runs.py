"""Carrying out the job of a background run: all of its files appear at the end, or none."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path, PurePath
from typing import Any

import numpy as np

from app.command.network_run import KEPT_BYTES, Stage, input_files
from app.command.results import write_content
from app.run.evaluation import Evaluation, TimedWork, planned
from app.run.job import FRAMES, REPORT, Job, Preview, Result, Steps
from app.run.option_values import Assignment, Save
from app.run.output import find_output
from app.run.overrides import GivenNetwork, named_parameter
from app.run.process import too_late
from app.run.readout_tables import warning_lines
from app.run.saving import encode_png, grey_levels, robust_limits
from app.run.shipped import Place
from app.run.staging import Staging, check_folder, real_target
from app.run.way_of_running import way_of_running
from app.run.write_rules import WriteRecord, WriteRules, read_record
from app.tradeoff.tradeoff_drawing import trade_off_content
from app.tradeoff.tradeoff_results import default_figures, shown_value, trade_off
from app.tradeoff.values import Variation
from core.atomic import write_text
from core.chain.engine import Engine, realize
from core.errors import ImagechainError, InputError, UsageError, printable
from core.evaluation.store import Store
from core.evaluation.work import Policy
from core.modules.declaration import Library, declaration
from core.network.file import parse_network
from core.network.network import Network
from core.network.validation import plain_network
from nodes.files.common.table_cells import csv_lines
from nodes.library import standard_library

UNSAVED = "unsaved network"
TRADE_OFF_PAGE, TRADE_OFF_TABLE, READOUT_TABLE = "tradeoff.html", "tradeoff.csv", "readouts.csv"
MOST_PREVIEWS, PREVIEW_PX = 24, 256
_POLICY = Policy()
_FIGURES = 0.2  # of what a picture takes, at the same value
_HOW_TO_ALLOW = "choose the file with Browse… on its control panel, or choose another output folder"


def carry_out(job: Job, cancel: threading.Event | None, steps: Steps) -> Result:
    library = standard_library()
    path = job.path if job.path is not None else job.folder / UNSAVED
    place = Place(path, path.stem)
    document = parse_network(job.network, library=library, name_of_source=str(path))
    network = plain_network(document, library=library)
    running = _Running(replace(job, output=job.output.absolute()), place, library, cancel, steps)
    return running.report(network) if job.kind == "report" else running.runs(network)


class _Made:
    def __init__(self) -> None:
        self.failures: list[tuple[str, str]] = []
        self.errors: list[ImagechainError] = []
        self.warnings: list[str] = []
        self.previews: list[Preview] = []
        self._figures: dict[str, dict[str, float]] = {}

    def look(self, name: str, evaluation: Evaluation) -> None:
        if len(self.previews) < MOST_PREVIEWS and evaluation.chain.final is not None:
            self.previews.append(_preview(name, evaluation))

    def done(self, name: str, evaluation: Evaluation) -> None:
        lines = warning_lines(evaluation.cautions)
        self.warnings += [f"{name}: {line}" if name else line for line in lines]
        self._figures[name] = {
            f"{node}.{readout}": value
            for node, values in evaluation.readouts.items()
            for readout, value in values.items()
            if isinstance(value, int | float) and not isinstance(value, bool)
        }

    def failed(self, name: str, error: ImagechainError) -> None:
        self.previews = [preview for preview in self.previews if preview.name != name]
        self.errors.append(error)
        self.failures.append((name, str(error)))

    def table(self) -> str:
        columns = dict.fromkeys(name for row in self._figures.values() for name in row)
        rows = [
            [name, *(row.get(column, "") for column in columns)]
            for name, row in self._figures.items()
        ]
        return printable(csv_lines([["run", *columns], *rows]))


@dataclass(frozen=True)
class _Running:
    job: Job
    place: Place
    library: Library
    cancel: threading.Event | None
    steps: Steps

    def report(self, network: Network) -> Result:
        start = time.perf_counter()
        file, engine = self.job.output, Engine(self.library)
        plan = planned(engine, self._with(network), self.place.folder)
        way = way_of_running(plan, _POLICY, None)
        if way.in_blocks:
            engine = Engine(self.library, way.store(None))
        made = _Made()
        self.steps.expect(2)
        self.steps.part("", nodes=len(plan.nodes))

        def look(evaluation: Evaluation) -> None:
            made.look("", evaluation)
            self.steps.part("writing the report")

        with Staging(None, [self.place.path, *input_files(plan, plan.folder)]) as staging:
            work = self._work(engine)
            stage = Stage(
                file.parent, staging, self._rules(), look=look, way=way, only_report=True,
                reports=(file,),
            )  # fmt: skip
            made.done("", stage.prepare(engine, plan, work, start=start)[0])
            work.check()
            too_late(self.cancel)
            staging.commit()
        return Result(1, (), tuple(made.warnings), file, tuple(made.previews))

    def runs(self, network: Network) -> Result:
        job, made, variants = self.job, _Made(), self.job.variants
        check_folder(job.output)
        rules = self._rules()
        engine = Engine(self.library, None if job.report else Store(KEPT_BYTES))
        figures = 0.0 if job.kind != "sweep" else _FIGURES if variants else 1.0
        self.steps.expect(len(variants) + job.frames + figures * len(job.values))
        chosen = [self.place.folder / file for file in job.values if job.kind == "files"]
        with Staging(job.output, [self.place.path, *chosen]) as staging:
            for name, value in variants:
                folder, look = job.output / name, partial(made.look, name)
                stage = Stage(folder, staging, rules, self._frame_done, look)
                try:
                    made.done(name, self._run(network, name, value, engine, stage))
                except InputError as error:
                    if not name:
                        raise
                    staging.drop(folder)
                    made.failed(name, error)
            if variants and len(made.failures) == len(variants):
                raise made.errors[0]
            page = self._trade_off(network, engine, staging, figures)
            if job.kind == "files":
                table = partial(write_text, content=made.table())
                staging.write(job.output / READOUT_TABLE, table)
            self._work(engine).check()
            too_late(self.cancel)
            forgotten = self._commit(rules, staging)
        if forgotten:
            made.warnings.append(
                f"could not record the written files for the next run: {forgotten}"
            )
        if page is None and job.report and not variants[0][0]:
            page = job.output / REPORT
        failures, warnings = tuple(made.failures), tuple(made.warnings)
        return Result(max(1, len(variants)), failures, warnings, page, tuple(made.previews))

    def _run(
        self, network: Network, name: str, value: Any, engine: Engine, stage: Stage
    ) -> Evaluation:
        start = time.perf_counter()
        settings: tuple[Assignment, ...] = ()
        if name:
            node, _, parameter = self.job.target.rpartition(".")
            # The window's file names are relative to the network, not to this process.
            given = str(self.place.folder / value) if self.job.kind == "files" else value
            settings = (Assignment(node, parameter, json.dumps(given)),)
        network = self._with(network, settings)
        if name:
            network = _writing_to(network, self.library, stage.folder)
        plan = planned(engine, network, self.place.folder)
        for path in input_files(plan, plan.folder):
            stage.staging.protect(path)
        if self.job.frames:
            port = find_output(plan)
            if port.port is None:
                raise UsageError(
                    f"{port.missing}: press O on the node whose picture you want as frames"
                )
            node, _, picture = port.port.rpartition(".")
            save = Save(node, picture, str(stage.folder / FRAMES))
            stage = replace(stage, frames=self.job.frames, saves=(save,))
        self.steps.part(name, nodes=len(plan.nodes))
        reports = (stage.folder / REPORT,) if self.job.report else ()
        stage = replace(stage, reports=reports, way=way_of_running(plan, _POLICY, None))
        evaluation, _ = stage.prepare(engine, plan, self._work(engine), start=start)
        return evaluation

    def _trade_off(
        self, network: Network, engine: Engine, staging: Staging, weight: float
    ) -> Path | None:
        job = self.job
        if job.kind != "sweep":
            return None
        network = self._with(network)
        node, _, name = job.target.rpartition(".")
        setting = Assignment(node, name, "")
        parameter = named_parameter("sweep", setting, network, library=self.library)
        assert parameter is not None  # the network has been checked
        varied = Variation(node, parameter, job.values, job.log)
        plan, work = engine.plan(network, folder=self.place.folder), self._work(engine)
        figures = default_figures(network, self.library)
        shown = [f"{varied.text} = {shown_value(value, varied.unit)}" for value in job.values]

        def reach(count: int) -> None:
            if count < len(shown):
                doing = f"figures at {shown[count]}"
                self.steps.part(doing, nodes=len(plan.nodes), weight=weight)

        reach(0)
        name = network.name or self.place.name
        results = trade_off(
            engine, plan, work, varied, None, figures, name=name, by_default=True, reached=reach
        )
        if (why := results.why_nothing()) is not None:
            if job.pictures:
                return None  # there are the pictures
            raise UsageError(f"no value of {varied.text} gives a figure{why and f': {why}'}")
        for file in (TRADE_OFF_PAGE, TRADE_OFF_TABLE):
            content = trade_off_content(results, Path(file))
            staging.write(job.output / file, partial(write_content, content=content))
        return job.output / TRADE_OFF_PAGE

    def _with(self, network: Network, settings: Iterable[Assignment] = ()) -> Network:
        return GivenNetwork(self.place, tuple(settings)).changed(network, self.library)[0]

    def _work(self, engine: Engine) -> TimedWork:
        return TimedWork(_POLICY, engine.store, self.steps.node, self.cancel)

    def _rules(self) -> WriteRules:
        job, path = self.job, self.place.path
        record = WriteRecord(path) if job.path is None else read_record(path)
        output = real_target(job.output)
        own = () if job.path is None else (real_target(self.place.folder),)
        return WriteRules(
            folders=(*own, output),
            allowed=(output,) if job.kind in ("sweep", "files") else (),  # no node names the file
            given=frozenset(),
            record=replace(record, chosen=record.chosen | {*map(real_target, job.chosen)}),
            how_to_allow=_HOW_TO_ALLOW,
        )

    def _commit(self, rules: WriteRules, staging: Staging) -> str:
        """Put the files in place; why what nodes wrote could not be recorded, or empty."""
        if self.job.path is None:  # there is no network to record it of
            staging.commit()
            return ""
        return rules.commit(staging)

    def _frame_done(self, number: int) -> None:
        if number == 1:
            self.steps.part("frames", weight=self.job.frames)
        self.steps.piece(number, self.job.frames)


def _writing_to(network: Network, library: Library, folder: Path) -> Network:
    for node in network.nodes.values():
        path = node.params.get("path")
        sink = node.module in library and declaration(library[node.module]).sink
        if sink and isinstance(path, str) and path:
            network = network.with_parameter(node.id, "path", str(folder / PurePath(path).name))
    return network


def _preview(name: str, evaluation: Evaluation) -> Preview:
    """The delivered picture, every so many samples, as a run's PNG shows it."""
    assert evaluation.chain.final is not None
    samples = realize(evaluation.plan.output(evaluation.chain.final), evaluation.work)
    step = max(1, -(-max(samples.shape) // PREVIEW_PX))
    levels = grey_levels(*robust_limits(samples), np.ascontiguousarray(samples[::step, ::step]))
    return Preview(name, encode_png(levels))
