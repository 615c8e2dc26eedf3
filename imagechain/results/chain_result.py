"""The result of a run; pictures and figures not yet computed are computed on access."""

import os
from collections.abc import Callable, Iterable, Sequence
from functools import cached_property, partial
from os import PathLike, fspath
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.command.network_run import input_files, sink_files, sink_targets
from app.run.evaluation import Evaluation, TimedWork, blocks_of, evaluate, way_of_running
from app.run.option_values import size_in_bytes
from app.run.saving import MOST_FRAMES, check_suffix, cube_of, is_cube, real_array, save_value
from app.run.staging import Staging, WriteRules, read_record
from app.run.transfer_chain import find_output, ports_of_images
from core import errors
from core.chain.engine import Engine, Plan, asked_for
from core.chain.random_fields import at_frame
from core.chain.skipped import skips
from core.chain.wires import Image
from core.evaluation.recipes import Region
from core.evaluation.work import Policy
from core.machine import store_bytes
from core.modules.parameters import Caution
from imagechain.parts.plain_errors import block, plain_errors, stays_here, table
from imagechain.results import tables
from nodes.files.formats import check_finite
from nodes.files.frames import header_beside_frames

_REGION = "two slices for rows and columns, such as numpy.s_[100:164, :64]"


class RunOptions:
    """Options of a run, as for `Chain.run`, and where the chain may write."""

    def __init__(
        self,
        policy: Policy,
        frames: int | None,
        outputs: Sequence[str] | None,
        region: tuple[slice, slice] | None,
        memory: int | str | None,
        scratch: str | PathLike[str] | None,
        file: Path | None,
        given: Iterable[str],
    ) -> None:
        if frames is not None and not (_is_whole(frames) and 1 <= frames <= MOST_FRAMES):
            raise errors.ParameterError("frames", frames, f"a whole number from 1 to {MOST_FRAMES}")
        if region is not None and not (
            isinstance(region, tuple)
            and len(region) == 2
            and all(isinstance(part, slice) and part.step in (None, 1) for part in region)
        ):
            raise errors.ParameterError("region", region, _REGION)
        chosen = (outputs,) if isinstance(outputs, str) else outputs
        self.policy, self.frames, self.region = policy, frames, region
        self.outputs = None if chosen is None else tuple(chosen)
        self.memory = _bytes(memory)
        self.scratch = current_folder() if scratch is None else Path(fspath(scratch))
        self.file, self.given = file, frozenset(given)

    def region_of(self, shape: tuple[int, int]) -> Region | None:
        """The rows and columns to compute in a picture of the given shape; None means all."""
        if self.region is None:
            return None
        (top, bottom, _), (left, right, _) = map(slice.indices, self.region, shape)
        if bottom <= top or right <= left:
            allowed = f"{_REGION}, within the picture's {shape[0]} rows and {shape[1]} columns"
            raise errors.ParameterError("region", self.region, allowed)
        return Region(top, left, bottom - top, right - left)


def current_folder() -> Path:
    """The current folder; its former path if the folder has been removed."""
    try:
        return Path.cwd()
    except FileNotFoundError:
        return Path(os.environ.get("PWD", "/"))


def whole_path(path: str | PathLike[str]) -> Path:
    """The absolute path of a file; links are not resolved."""
    return Path(os.path.normpath(current_folder() / fspath(path)))


def _bytes(memory: int | str | None) -> int | None:
    if isinstance(memory, str):
        return size_in_bytes("memory", memory)
    if memory is None or (_is_whole(memory) and memory >= 1000):
        return memory
    raise errors.ParameterError(
        "memory", memory, 'a number of bytes, 1000 or more, or a string such as "2GB"'
    )


def _is_whole(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool)


Smaller = Callable[[errors.ImagechainError], Plan]


class Result:
    """The result of a run, with the chain as it was during the run.

    Pictures and figures that the run did not compute are computed when you access them.
    """

    def __init__(
        self, engine: Engine, plan: Plan, options: RunOptions, work: TimedWork, smaller: Smaller
    ) -> None:
        self._engine, self._plan, self._options = engine, plan, options
        self._work, self._smaller = work, smaller
        self._values: dict[str, NDArray[Any]] = {}

    __reduce__ = stays_here

    # Pictures

    @property
    def final(self) -> str | None:
        """Port of the final picture; None if the port cannot be determined."""
        return find_output(self._plan).port

    @plain_errors
    def image(self, port: str | None = None) -> NDArray[Any]:
        """The samples of a picture, read-only: (rows, columns), or (frames, rows, columns).

        Parameters
        ----------
        port : str, optional
            ``NODE.PORT``; by default the final picture.
        """
        return self._samples(self._port(port))

    @plain_errors
    def picture(self, port: str | None = None) -> tables.Picture:
        """A picture with its unit, sampling interval and band; `port` is as for `image`."""
        name = self._port(port)
        image, samples = self._image(name), self._samples(name)
        intervals = image.interval_x_mrad, image.interval_y_mrad
        bands = () if image.bands is None else image.bands.centres_um
        inside = image, self._work, self._region(image)
        return tables.Picture(name, samples, image.unit, intervals, image.band_um, bands, *inside)

    @property
    def images(self) -> tables.Images:
        """Samples of every picture, by ``NODE.PORT``; each is computed when you access it."""
        return tables.Images(ports_of_images(self._plan), self.image)

    @plain_errors
    def value(self, port: str) -> Any:
        """The value at a port ``NODE.PORT``.

        A picture gives its samples; a magnitude, phase or transfer function gives the full array in
        FFT order; curves give a `CurveData`, and a table gives a `TableData`.
        """
        value = self._plan.output(port)
        if isinstance(value, Image):
            return self._samples(port)
        return self._engine.value(self._plan, port, self._work)

    @plain_errors
    def save(self, path: str | PathLike[str], port: str | None = None) -> Path:
        """Write the value at a port in the format of the file's suffix, as ``run --save`` does.

        Parameters
        ----------
        path : path
            ``.npy``, ``.exr``, ``.tif``, ``.png``, ``.csv``, ``.zarr`` or ``.img``; ``.img`` keeps
            all bands of a picture, with a header file beside it.
        port : str, optional
            ``NODE.PORT``; by default the final picture.
        """
        target, name = Path(fspath(path)), port if port is not None else self._port(None)
        value = self._plan.output(name)
        check_suffix(name, value, target)
        region = self._region(value) if isinstance(value, Image) else None
        if self._options.frames is not None and isinstance(value, Image):
            raise errors.UsageError(
                f"{target}: save writes one frame only; for several frames, use imagechain "
                "run --frames"
            )
        save_value(value, target, self._work, port=name, region=region)
        if isinstance(value, Image) and is_cube(value, target):
            cube = cube_of(value, self._work.policy, region)
            cube.write_header(header_beside_frames(target))
        return target

    # Figures

    @property
    @plain_errors
    def readouts(self) -> tables.ReadoutTable:
        """Read-outs of every node: ``result.readouts["electronics"]["netd_system_K"]``."""
        return tables.ReadoutTable(self._evaluation)

    @plain_errors
    def curves(self, angle_deg: float | None = None) -> tables.StageCurves:
        """MTF and PTF of every stage and of the product of all stages, from zero to Nyquist.

        Parameters
        ----------
        angle_deg : float, optional
            Angle of a line in the frequency plane, from ξ (0°) to η (90°); by default, the curves
            are along the ξ axis and the η axis.
        """
        return tables.curves_of(self._evaluation, None if angle_deg is None else float(angle_deg))

    @property
    @plain_errors
    def warnings(self) -> tuple[Caution, ...]:
        """Warnings from the modules, including warnings about samples."""
        return self._evaluation.cautions

    @property
    def seconds(self) -> dict[str, float]:
        """Computing time of each node, s; reused values take no time."""
        return dict(self._work.seconds)

    @property
    def seed(self) -> int:
        """Seed of the noise."""
        return self._plan.network.seed

    @plain_errors
    def report(self, path: str | PathLike[str]) -> Path:
        """Write a report, as ``imagechain run --report`` does: ``.html`` or ``.json``."""
        from app.report.report_facts import write_report
        from app.run.option_values import report_path

        target = report_path("--report", fspath(path))
        evaluation = self._evaluation
        import matplotlib  # noqa: F401  (first, so that it has the user's settings)

        write_report(evaluation, skips(self._plan, self._work), target)
        return target

    @plain_errors
    def write_files(self, *, allow: Iterable[str | PathLike[str]] = ()) -> list[Path]:
        """Write the files of the chain's write nodes, all or none; returns their paths.

        Parameters
        ----------
        allow : iterable of path
            Further folders where a network from a file may write and overwrite any file. Without
            `allow`, the network may write only in its own folder, and overwrite only files that it
            has written itself. Files that were named in Python are always written.
        """
        evaluation, plan, origin = self._evaluation, self._plan, self._options
        targets = sink_targets(plan)
        file = origin.file if origin.file is not None else plan.folder / "chain without a file.json"
        rules = WriteRules(
            folders=(Path(os.path.realpath(plan.folder)),),
            allowed=tuple(Path(os.path.realpath(fspath(one))) for one in allow),
            given=origin.given,
            record=read_record(file),
            how_to_allow="write_files(allow=[{folder}]) allows it",
        )
        with Staging(None, [file, *input_files(plan)]) as staging:
            for node, path in targets.items():
                staging.claim(path, partial(rules.check, node))
            for _, path, writer in sink_files(evaluation):
                staging.write(path, writer)
            if origin.file is None:
                staging.commit()
            else:
                rules.commit(staging)
        return list(targets.values())

    # Inside

    @cached_property
    def _evaluation(self) -> Evaluation:
        while True:
            try:
                return evaluate(self._engine, self._plan, self._work)
            except errors.ImagechainError as error:
                self._plan = self._smaller(error)

    def _port(self, port: str | None) -> str:
        if port is not None:
            return port
        output = find_output(self._plan)
        if output.port is None:
            raise errors.NetworkError(
                f"{output.missing}: name a port (NODE.PORT), or use chain.mark_final(NODE)"
                if output.choices
                else output.missing
            )
        return output.port

    def _image(self, port: str) -> Image:
        names = [*ports_of_images(self._plan)]
        inner = self._plan.network.port_names.get(port, port)
        if inner not in names and inner.rpartition(".")[0] in self._plan.nodes:
            hint = errors.close(port, names) or f"; the pictures are {', '.join(names) or 'none'}"
            raise errors.NetworkError(f"{errors.shown(port)} is not a picture of the chain{hint}")
        value = self._plan.output(port)
        assert isinstance(value, Image)
        return value

    def _samples(self, port: str) -> NDArray[Any]:
        if port in self._values:
            return self._values[port]
        image = self._image(port)
        region = self._region(image)
        with errors.placed(port.rpartition(".")[0]):
            if self._options.frames is None:
                samples = self._engine.value(self._plan, port, self._work, region)
                check_finite(samples, port)
            else:
                recipes = (at_frame(image.recipe, number) for number in range(self._options.frames))
                frames = self._work.one_by_one(recipes, region, forgetting=True)
                shape = image.shape if region is None else region.shape
                samples = np.empty((self._options.frames, *shape), self._work.policy.dtype)
                for number, frame in enumerate(frames):
                    samples[number] = real_array(frame, self._work)
                    check_finite(samples[number], port)
        return self._values.setdefault(port, _read_only(samples))

    def _region(self, image: Image) -> Region | None:
        return self._options.region_of(image.shape)

    def __repr__(self) -> str:
        parts = [
            errors.shown(self._plan.network.name) if self._plan.network.name else "",
            self.final,
        ]
        words = ", ".join([*filter(None, parts), f"{self._work.policy.precision} precision"])
        return f"<Result: {words}>"

    def _repr_html_(self) -> str:
        parts = []
        if self.final is not None:
            parts.append(self.picture()._repr_html_())
        if self._evaluation.cautions:
            lines = [(str(caution),) for caution in self.warnings]
            parts.append(table(("warnings",), lines))
        parts.append(self.readouts._repr_html_())
        return block(*parts)


def run_plan(engine: Engine, plan: Plan, options: RunOptions, smaller: Smaller) -> Result:
    """Compute the ports named in the options, by default the final picture."""
    way = way_of_running(plan, options.policy, options.memory)
    if way.in_blocks and (options.frames or 1) > 1:
        raise errors.ParameterError(
            "frames", options.frames, "must be 1 for pictures that are computed in blocks"
        )
    most = store_bytes() if options.memory is None else min(store_bytes(), options.memory)
    engine.store.capacity_bytes = most if way.store_bytes is None else way.store_bytes
    work = TimedWork(options.policy, engine.store, workers=engine.workers)
    result = Result(engine, plan, options, work, smaller)
    ports = options.outputs
    if ports is None:
        ports = tuple(filter(None, [find_output(plan).port]))
    policy, scratch = options.policy, options.scratch
    with (
        blocks_of(
            way, engine, plan, policy, ports=ports, report=False, scratch=scratch
        ) as work.blocks,
        work.hold(recipe for port in ports for recipe in asked_for(plan.output(port))),
    ):
        everything = options.outputs is None and options.region is None
        if everything and (way.in_blocks or not ports):
            result._evaluation  # noqa: B018  (computed here, and kept)
        for port in ports:
            result.value(port)
    return result


def _read_only(samples: NDArray[Any]) -> NDArray[Any]:
    """A view that nobody can make writable again, because its base is read-only too."""
    owner: Any = samples
    while isinstance(owner, np.ndarray):
        owner.flags.writeable = False
        owner = owner.base
    return samples.view()
