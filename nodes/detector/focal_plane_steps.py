"""The stages of Focal Plane as steps: from radiance to electrons to digital numbers."""

from collections.abc import Callable
from functools import wraps
from typing import Any, TypeVar

import numpy as np

from core.arrays import Array
from core.chain.random_fields import Stream
from core.chain.step_lineage import AtStep, LevelChange, Noise, picture_step
from core.chain.wires import TableData, TableRow
from core.evaluation.recipes import (
    Recipe,
    Region,
    Seen,
    Step,
    by_region,
    ends_lineage,
    in_blocks,
    marked,
    pointwise,
)
from core.evaluation.work import Work
from core.physics.detector import focal_plane_array
from core.physics.noise.flicker_noise import poisson_of_normal
from nodes.detector.focal_plane_figures import (
    ElectronLevels,
    bent_level,
    radiance_level,
    scene_level,
)
from nodes.shared.steps import AboutMean, Scaled, rounding_noises

_LEAST_SAMPLES, _MOST_SAMPLES = 1 << 15, 1 << 18
"""What a stage works on at once, as large as leaves work for all threads: two threads wait for each
other between numpy's calls. At 1024² five stages took 14 ms in blocks of the least size, 7 ms in
those of the most, and in one thread 10 ms in either."""
_EXACT_BITS = 14  # numbers beyond are made in double, whose rounding is far below one

Well = float | None
Function = TypeVar("Function", bound=Callable[..., Any])


def _by_rows(fill: Callable[..., None]) -> Callable[..., Array]:
    """A step of a function that fills blocks of rows, given those of all pictures, in threads."""

    @pointwise
    @wraps(fill)
    def step(work: Work, picture: Array, *others: Any, **how: Any) -> Array:
        made = np.empty(picture.shape, picture.dtype)
        rows, columns = picture.shape
        share = -(-picture.size // work.policy.workers)
        height = max(1, min(max(share, _LEAST_SAMPLES), _MOST_SAMPLES) // max(1, columns))

        def one(top: int) -> None:
            block = slice(top, top + height)
            inputs = (x[block] if isinstance(x, np.ndarray) else x for x in (picture, *others))
            fill(made[block], *inputs, **how)

        work.for_each(one, range(0, rows, height))
        return made

    return step


def _about(level: Callable[..., LevelChange]) -> Callable[[Function], Function]:
    """Mark a step that is linear in small differences about the mean, as `level` has it."""

    def change(_: Recipe, levels: Recipe, **how: Any) -> AboutMean:
        return AboutMean(Step.of(level, levels, **how))

    return picture_step(linear=change, looks_at=("levels",))


@_about(scene_level)
@_by_rows
def expected_electrons(made: Array, image: Array, levels: ElectronLevels) -> None:
    np.add(levels.conversion.times(image), image.dtype.type(levels.pedestal_e), out=made)


@in_blocks()
def _collected_noises(
    at: AtStep, mean: Recipe, *_: Recipe, frames: int, prnu_percent: float, dsnu_e: float
) -> list[Noise]:
    """Shot noise of each sample's own electrons; PRNU by its electrons, DSNU alike for all."""
    expected = at.work.value(mean)
    electrons = at.by_rows(lambda e: np.maximum(np.asarray(e, np.float64), 0.0), expected)
    noises = [at.white("shot", at.by_rows(lambda e: e / frames, electrons))]
    if prnu_percent:
        share = prnu_percent / 100.0
        variance: float | Array = (share * np.float64(electrons.mean())) ** 2
        if not at.uniform:
            variance = at.by_rows(lambda e: (share * e) ** 2, electrons)
        noises.append(at.white("PRNU", variance, temporal=False))
    if dsnu_e:
        noises.append(at.white("DSNU", dsnu_e**2, temporal=False))
    return noises


@picture_step(noise=_collected_noises, looks_at=("mean",))
@_by_rows
def collected(
    made: Array, mean: Array, *deviates: Array, frames: int, prnu_percent: float, dsnu_e: float
) -> None:
    """Electrons in one frame, or the average of several: shot noise, then PRNU, then DSNU."""
    number = mean.dtype.type
    poisson_of_normal(mean if frames == 1 else mean * number(frames), deviates[0], out=made)
    if frames != 1:
        made /= number(frames)
    if prnu_percent:
        factor = deviates[1] * number(prnu_percent / 100.0)
        factor += number(1.0)
        made *= factor
    if dsnu_e:
        made += deviates[-1] * number(dsnu_e)


@in_blocks()
def _excess(
    at: AtStep, picture: Recipe, mean: Recipe, *_: Recipe, frames: int, factor: float
) -> list[Noise]:
    electrons = at.work.value(mean)
    share = (factor - 1.0) / frames
    power = at.by_rows(lambda e: np.maximum(np.asarray(e, np.float64), 0.0) * share, electrons)
    return [at.white("excess", power)]


@picture_step(noise=_excess, looks_at=("mean",))
@_by_rows
def multiplied(
    made: Array, picture: Array, mean: Array, deviates: Array, *, frames: int, factor: float
) -> None:
    """Behind a noisy charge gain, over that gain; `mean` is for the noise that it adds."""
    number = picture.dtype.type(frames)
    charge = picture if frames == 1 else picture * number
    focal_plane_array.multiplied_charge(
        electrons=charge, deviates=deviates, excess_noise_factor=factor, out=made
    )
    if frames != 1:
        made /= number


@_about(bent_level)
@_by_rows
def bent(made: Array, picture: Array, levels: ElectronLevels, **response: float) -> None:
    focal_plane_array.bent_response(electrons=picture, out=made, **response)


@in_blocks()
def _read_noise(at: AtStep, *_: Recipe, sigma_e: float, **__: Well) -> list[Noise]:
    return [at.white("read", sigma_e**2)] if sigma_e else []


@picture_step(
    linear=lambda _, clipping, *__, **___: AboutMean(clipping, scales_noise=False),
    noise=_read_noise,
    noise_free=lambda picture, *_, **__: picture,
    looks_at=("clipping",),
)
@_by_rows
def read_out(
    made: Array, picture: Array, clipping: Any, *deviates: Array, sigma_e: float, full_well_e: Well
) -> None:
    """With read noise, up to the well; `clipping` is for what follows the scene through it."""
    number = picture.dtype.type
    if deviates:
        np.multiply(deviates[0], number(sigma_e), out=made)
        made += picture
    else:
        made[:] = picture
    if full_well_e is not None:
        # A third of the time of numpy's minimum by a number.
        np.clip(made, number(-np.inf), number(full_well_e), out=made)


Places = tuple[Array, Array]
"""Rows and columns of pixels."""


def bad_pixels(
    work: Work, *, stream: Stream, shape: tuple[int, int], percent: float
) -> list[Places]:
    rows, columns = shape
    places, kinds = focal_plane_array.bad_pixel_places(
        rows=rows, columns=columns, percent=percent, generator=stream.generator(0)
    )
    return [
        np.divmod(places[kinds == kind], columns)
        for kind in (focal_plane_array.DEAD, focal_plane_array.HOT)
    ]


@picture_step(noise=lambda at, *_, **__: [at.known("bad pixels")])
@by_region(lambda picture, *_, **__: picture.shape)
def with_bad_pixels(
    work: Work, region: Region, picture: Seen, bad: Seen, levels: Seen, *, hot_e: float | None
) -> Array:
    """Dead pixels give nothing, hot ones the most there is, in every frame."""
    changed = picture(region).copy()
    hot = 2.0 * levels(region).brightest_e if hot_e is None else hot_e
    for (rows, columns), value in zip(bad(region), (0.0, hot), strict=True):
        y, x = rows - region.top, columns - region.left
        inside = (y >= 0) & (y < region.rows) & (x >= 0) & (x < region.columns)
        changed[y[inside], x[inside]] = value
    return np.asarray(changed)


def _counts(picture: Recipe, *, gain_e_per_dn: float, **how: float) -> Scaled:
    return Scaled(1.0 / gain_e_per_dn)


@picture_step(linear=_counts)
@_by_rows
def counted(made: Array, picture: Array, *, gain_e_per_dn: float, offset_dn: float) -> None:
    np.divide(picture, picture.dtype.type(gain_e_per_dn), out=made)
    made += picture.dtype.type(offset_dn)


@in_blocks()
def _rounding(at: AtStep, picture: Recipe, **how: float) -> list[Noise]:
    return rounding_noises(at, 1.0)


def _not_rounded(picture: Recipe, *, bits: int, **how: Any) -> Step:
    return Step.of(counted, picture, **how)


@marked(whole_numbers=True)
@picture_step(linear=_counts, noise=_rounding, noise_free=_not_rounded)
@_by_rows
def digitized(made: Array, picture: Array, *, bits: int, **scale: Any) -> None:
    kind = picture.dtype if bits <= _EXACT_BITS else np.dtype(np.float64)
    numbers = _numbers(picture, kind, **scale, out=made)
    np.clip(numbers, 0.0, kind.type(2.0**bits - 1.0), out=numbers)
    if numbers is not made:
        made[:] = numbers


def _numbers(
    electrons: Array, kind: Any, *, gain_e_per_dn: float, offset_dn: float, out: Any = None
) -> Array:
    """Rounded, of any size; in `out` where that is of the kind."""
    place = out if out is not None and out.dtype == kind else None
    numbers = np.divide(electrons, kind.type(gain_e_per_dn), out=place)
    numbers += kind.type(offset_dn)
    return np.asarray(np.rint(numbers, out=numbers))


@picture_step(linear=lambda _, gain_e_per_dn, **__: Scaled(gain_e_per_dn))
@_by_rows
def electrons_of_counts(
    made: Array, picture: Array, *, gain_e_per_dn: float, offset_dn: float
) -> None:
    np.subtract(picture, picture.dtype.type(offset_dn), out=made)
    made *= picture.dtype.type(gain_e_per_dn)


@_about(radiance_level)
@_by_rows
def radiance_of_electrons(made: Array, picture: Array, levels: ElectronLevels) -> None:
    """Radiance of the scene that electrons stand for, less what is there without it."""
    pedestal = picture.dtype.type(levels.pedestal_e)
    made[:] = levels.conversion.inverse.times(picture - pedestal)
    if levels.radiance_per_photon is not None:
        made *= made.dtype.type(levels.radiance_per_photon)


@ends_lineage
@pointwise
def saturated_pixels(
    work: Work, electrons: Array, *, full_well_e: Well, bits: int, **numbers: Any
) -> Array:
    """1 where the well is full, or the number would be beyond the converter's last one."""
    number = electrons.dtype.type
    marked = np.zeros(electrons.shape, bool)
    if full_well_e is not None:
        marked |= electrons >= number(full_well_e)
    if bits:
        kind = electrons.dtype if bits <= _EXACT_BITS else np.dtype(np.float64)
        marked |= _numbers(electrons, kind, **numbers) > 2.0**bits - 1.0
    return marked.astype(electrons.dtype)


@in_blocks()
def with_saturated(work: Work, table: TableData, marked: Array) -> TableData:
    meaning = "pixels clipped at the full well or at the converter's highest number"
    row = TableRow("saturated_pixels", int(np.count_nonzero(marked)), "", meaning)
    return TableData((*table.rows, row))
