"""One run of a network: what it computes, and the files that it writes, all of them or none."""

import time
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Self

from app.run import evaluation as run
from app.run import option_values, overrides, saving
from app.run.staging import Staging, WriteRules, existing_folder, input_paths
from app.run.terminal import columns, json_text, warning_lines
from app.run.transfer_chain import find_output, how_to_choose, mtf_csv
from core.atomic import write_bytes, write_text
from core.chain.engine import Engine, Plan, realize
from core.chain.skipped import Skip, skips
from core.chain.wires import Image
from core.errors import UsageError, in_line, placed
from core.evaluation.recipes import Region
from core.evaluation.work import Policy
from core.modules.declaration import NodeContext
from core.network.validation import NetworkProblems
from core.records import asdict, dataclass, field
from nodes.files import file_format, formats
from nodes.files import frames as frame_files

FINAL, MTF, READOUTS = "final.png", "mtf.csv", "readouts.json"
KEPT_BYTES = 1 << 29
WARNINGS = "imagechain.warnings"  # in the read-outs; no node's name has a dot


@dataclass
class NetworkRun:
    """A planned network, what it is to write, and once that is prepared what it has given.

    The files are prepared in `staging`; whoever runs it puts them in place.
    """

    engine: Engine
    plan: Plan
    work: run.TimedWork
    folder: Path  # the output folder
    staging: Staging
    rules: WriteRules  # what the network may write
    only_report: bool = False
    saves: tuple[option_values.Save, ...] = ()
    frames: int | None = None  # of each picture that is saved
    reports: tuple[Path, ...] = ()
    memory_bytes: int | None = None  # for pictures; by default half of what the process may use
    scratch: Path | None = None  # the folder for pictures that do not fit into memory
    frame_done: Callable[[int], None] | None = None  # after each frame
    look: Callable[[run.Evaluation], object] | None = None  # while pictures are held
    # once it is prepared
    evaluation: run.Evaluation = field(init=False)
    skipped: tuple[Skip, ...] = field(init=False)
    figures: list[run.Figure] = field(init=False)

    def prepare(self, *, start: float) -> Self:
        engine, plan, work, staging = self.engine, self.plan, self.work, self.staging
        way = run.way_of_running(plan, work.policy, self.memory_bytes)
        if way.store_bytes is not None:
            engine.store.capacity_bytes = way.store_bytes
        for path in input_files(plan):
            staging.protect(path)
        saves = self._claim(way)
        if not self.only_report:
            own = own_files(plan, self.folder)
            if refused := self.rules.claim(sink_targets(plan), own, staging):
                raise NetworkProblems(refused) from refused[0]
        work.check()
        scratch, report = self.scratch or existing_folder(self.folder), bool(self.reports)
        ports = [saved.port for saved in saves]
        with (
            run.blocks_of(
                way, engine, plan, work.policy, ports=ports, report=report, scratch=scratch
            ) as work.blocks,
            work.hold(run.needed_later(plan, ports, report=report, in_blocks=way.in_blocks)),
        ):
            self.evaluation = evaluation = run.evaluate(engine, plan, work)
            evaluation.seconds["total"] = time.perf_counter() - start
            evaluation.way.update(way.facts(work.blocks))
            if self.only_report:
                sink_files(evaluation)  # made as a run does, which counts what was left out
            else:
                self._write(saves)
                self.figures = run.main_figures(evaluation)
            if self.look is not None:
                self.look(evaluation)
            self.skipped = skips(plan, work)  # before the reports, whose pictures need more
            for path in self.reports:
                from app.report.report_facts import write_report

                staging.write(path, partial(write_report, evaluation, self.skipped))
        return self

    @property
    def others(self) -> list[str]:
        """Files beside those of the folder."""
        saved = (save.text for save in self.saves)
        return [*saved, *map(str, (*self.reports, *sink_targets(self.plan).values()))]

    def _claim(self, way: run.WayOfRunning) -> list["_Saved"]:
        plan, staging, policy, frames = self.plan, self.staging, self.work.policy, self.frames
        if frames is not None and not 1 <= frames <= saving.MOST_FRAMES:
            most = saving.MOST_FRAMES
            raise UsageError(
                f"--frames {frames} is not allowed: must be a whole number from 1 to {most}"
            )
        values = [_port_value(plan, save.node, save.name) for save in self.saves]
        if frames is not None and not any(isinstance(value, Image) for value in values):
            example = find_output(plan).port or "NODE.PORT"
            raise UsageError(
                f"--frames {frames} needs --save, which names the picture and the file: "
                f"--save {example}=frames.npy"
            )
        saves, files = [], []
        for save, value in zip(self.saves, values, strict=True):
            path, region = Path(save.text), saving.region_of(save, value)
            saved = _Saved(path, save.port, value, region, frames)
            found = saved.series(policy, on_disk=way.on_disk(value, policy))
            if found is None:
                saving.check_suffix(save.port, value, path)
                if file_format.ZARR.matches(path):
                    found = saving.series_of(value, path, policy, frames=1, region=region)
            files += [] if found is None else [(path, found)]
            saves.append(saved)
            staging.claim(path)
        for path, _ in files:
            if file_format.ENVI_FRAMES.matches(path):
                staging.claim(frame_files.header_beside_frames(path))
        frame_files.refuse_without_room(files)
        for saved in saves:
            if way.on_disk(saved.value, policy):
                run.check_streamed(saved.port, saved.value, saved.path, frames)
        for path in self.reports:
            staging.claim(path)
        return saves

    def _write(self, saves: list["_Saved"]) -> None:
        evaluation, work, staging, folder = self.evaluation, self.work, self.staging, self.folder
        for saved in saves:
            staging.write(saved.path, partial(_save, evaluation, saved, self.frame_done))
            series = saved.series(work.policy, on_disk=_is_on_disk(saved.value, work))
            if series is not None and file_format.ENVI_FRAMES.matches(saved.path):
                text = frame_files.envi_header_text(series)
                staging.write(
                    frame_files.header_beside_frames(saved.path), partial(write_text, content=text)
                )
        for node, path, writer in sink_files(evaluation):
            staging.write(path, writer, partial(self.rules.check, node))
        if evaluation.chain.final is not None:
            staging.write(folder / FINAL, partial(_final_png, evaluation, evaluation.chain.final))
        staging.write(folder / MTF, partial(write_text, content=mtf_csv(evaluation.responses)))
        warnings: dict[str, list[str]] = {}
        for caution in evaluation.cautions:
            warnings.setdefault(caution.node, []).append(caution.text)
        readouts = {**evaluation.readouts, **({WARNINGS: warnings} if warnings else {})}
        staging.write(folder / READOUTS, partial(write_text, content=json_text(readouts)))

    def facts(self, left_out: Sequence[str]) -> dict[str, Any]:
        evaluation = self.evaluation
        return {
            "figures": self.figures,
            "readouts": evaluation.readouts,
            "warnings": [asdict(caution) for caution in evaluation.cautions],
            "skipped": [asdict(skip) for skip in self.skipped],
            "left_out": list(left_out),
            "way": evaluation.way,
            "files": [*map(str, own_files(evaluation.plan, self.folder)), *self.others],
        }

    def lines(self, *, every_readout: bool, on_memory: bool) -> list[str]:
        evaluation, tables = self.evaluation, []
        readouts = [row.texts for row in run.each_readout(evaluation) if row.value is not None]
        if self.figures and not every_readout:
            rows = [
                (name, f"{v} {unit}", of) for name, v, unit, of in run.figure_rows(self.figures)
            ]
            tables += [
                columns(rows),
                f"all {len(readouts)} read-outs: use --all, or see {READOUTS}\n",
            ]
        elif readouts:
            tables.append(columns(readouts, right=(2,)) + "\n")
        if warnings := warning_lines(evaluation.cautions):
            tables.append("\n".join(warnings) + "\n")
        lines = []
        below = [skip for skip in self.skipped if skip.kind == "below_budget"]
        if left_out := [f"{skip.node} (effect at most {skip.bound:.2g})" for skip in below]:
            budget = evaluation.work.policy.budget
            lines.append(
                f"left out within the error budget of {budget:.3g} of the picture's range: "
                f"{', '.join(left_out)}"
            )
        lines += [
            f"{skip.node}: {skip.text} (error at most {skip.bound:.2g} of each band's contrast)"
            for skip in self.skipped
            if skip.kind == "wavelengths"
        ]
        chain = evaluation.chain
        names = [FINAL, MTF, READOUTS] if chain.final is not None else [MTF, READOUTS]
        lines.append(f"{self.folder}: {', '.join(names)}")
        if chain.final is None:
            output = find_output(evaluation.plan)
            lines.append(f"no {FINAL}: {how_to_choose(output) or output.missing}")
        if chain.missing and chain.grid is not None:
            lines.append(f"no total MTF in {MTF}: {chain.missing}")
        if evaluation.way.get("way") == "in blocks" or on_memory:
            lines.append(run.way_in_words(evaluation.way))
        if self.others:
            lines.append(f"also {', '.join(self.others)}")
        return [*tables, *map(in_line, lines)]


def input_files(plan: Plan) -> list[Path]:
    nodes = [node for node in plan.nodes.values() if node.module is not None]
    return [path for n in nodes for path in input_paths(n.node, n.declaration, plan.folder)]


@dataclass(frozen=True)
class _Saved:
    path: Path
    port: str
    value: Any
    region: Region | None
    frames: int | None  # of an image, as many as were wanted

    def count(self, *, on_disk: bool) -> int | None:
        """Frames that it is written as; None where it is written in another way."""
        if not isinstance(self.value, Image):
            return None
        streamed = self.frames is None and run.is_streamed(self.value, self.path, on_disk=on_disk)
        return 1 if streamed else self.frames

    def series(self, policy: Policy, *, on_disk: bool) -> frame_files.FrameSeries | None:
        """What a file of frames or bands holds; None of any other file."""
        count = self.count(on_disk=on_disk)
        if count is not None:
            saving.check_for_frames(self.port, self.path)
            return saving.series_of(self.value, self.path, policy, frames=count, region=self.region)
        if not saving.is_cube(self.value, self.path):
            return None
        return saving.cube_of(self.value, policy, self.region).series


def own_files(plan: Plan, folder: Path) -> list[Path]:
    names = (FINAL, MTF, READOUTS) if find_output(plan).port is not None else (MTF, READOUTS)
    return [folder / name for name in names]


def sink_targets(plan: Plan) -> dict[str, Path]:
    targets = {}
    for name, node in plan.nodes.items():
        target = getattr(node.module, "target", None)
        if node.declaration.sink and not node.node.disabled and target is not None:
            targets[name] = target(NodeContext(name, plan.network.seed, plan.folder))
    return targets


def _port_value(plan: Plan, node: str, port: str) -> Any:
    name, _, output = plan.network.port_names.get(f"{node}.{port}", "").rpartition(".")
    if name:  # of a macro
        return plan.nodes[name].outputs[output]
    known = plan.nodes.get(node)
    if known is None:
        hint = overrides.near(node, plan.nodes)
        raise UsageError(f"--save {node}.{port}: the network has no node {node!r:.80}{hint}")
    if port not in known.outputs:
        hint = overrides.near(port, known.outputs)
        raise UsageError(f"--save {node}.{port}: {node} has no output {port!r:.80}{hint}")
    return known.outputs[port]


def _save(
    evaluation: run.Evaluation, saved: _Saved, done: Callable[[int], None] | None, path: Path
) -> None:
    value, work = saved.value, evaluation.work
    frames = saved.count(on_disk=_is_on_disk(value, work))
    port, region = saved.port, saved.region
    with placed(port.rpartition(".")[0]):
        if frames is not None:
            saving.save_frames(
                value, path, work, port=port, frames=frames, region=region, done=done
            )
        else:
            saving.save_value(value, path, work, port=port, region=region)


def _is_on_disk(value: Any, work: run.TimedWork) -> bool:
    return work.blocks is not None and isinstance(value, Image) and value.key in work.blocks.shapes


def sink_files(evaluation: run.Evaluation) -> list[tuple[str, Path, Callable[[Path], None]]]:
    files: list[tuple[str, Path, Callable[[Path], None]]] = []
    for name, node in evaluation.plan.nodes.items():
        if not node.declaration.sink or node.node.disabled:
            continue
        here = NodeContext(name, evaluation.network.seed, evaluation.plan.folder)
        module: Any = node.module
        with placed(name):
            files += [(name, *file) for file in module.files(node.inputs, here, evaluation.work)]
    return files


def _final_png(evaluation: run.Evaluation, port: str, path: Path) -> None:
    samples = realize(evaluation.plan.output(port), evaluation.work)
    formats.check_finite(samples, port)
    samples = run.reduced(samples, evaluation.work)
    write_bytes(path, saving.grey_png(samples))
