"""A network as plain data to the picture on one of its ports."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from slow_reference import camera, electronics, resampling
from slow_reference.filtering import crossed, filtered, filtered_at, filtered_lines
from slow_reference.numbers import PI
from slow_reference.pupil import exit_pupil_mtf
from slow_reference.transfer import MAGNITUDE, PHASE

LARGEST_DOUBT = 4.0  # times that a rounding error of a phase may grow
LONGEST_PHASE = 2000.0  # radians of a pattern that still have twelve digits behind the point


class IllConditionedError(Exception):
    """The result hangs on rounding: the phase of (nearly) nothing, or one of too many turns."""


@dataclass(frozen=True)
class Decisions:
    """Where a quantizer chose: distance of each sample to the turn, and of the levels.

    `scale` is that of the picture that was quantized.
    """

    distance: Any
    step: float
    scale: float


@dataclass(frozen=True)
class Picture:
    """Samples; `scale`, the largest number that has been added up on the way to them.

    `decisions` are the quantizers on the way, `last` the one that made these very samples. `edges`
    is how the last transform had the frame go on, if one did and nothing was cropped since.
    `between`, straight behind a transform, makes its picture at any (down, across) places.
    """

    samples: Any
    interval_x: Any
    interval_y: Any
    band_um: Any
    scale: float
    decisions: tuple = ()
    last: Decisions | None = None
    edges: str | None = None
    between: Any = None

    def then(self, samples, gain=1.0, **changes):
        scale = max(self.scale * gain, float(np.abs(samples).max()))
        made = self.decisions + ((self.last,) if self.last else ())
        changes = {"between": None, **changes}
        return replace(self, samples=samples, scale=scale, decisions=made, last=None, **changes)


@dataclass(frozen=True)
class Wire:
    """A spectrum on its way: whose it is, and the laws so far."""

    picture: Picture | None
    grid: Any
    edges: str
    laws: tuple = field(default=())

    def passed(self, law, p):
        if p["apply"] == "filter_only":
            return replace(self, picture=None, laws=(law,))
        return replace(self, laws=(*self.laws, law))


class SlowReference:
    """Values of ports, each worked out once.

    `document` is a network file as a dictionary in which no parameter is left out; `arrays` are
    the samples of the files it names, and their type is the one everything is computed in.
    """

    def __init__(self, document, arrays):
        self.nodes, self.arrays = document["nodes"], arrays
        self.sources = {end: start for start, end in document["links"]}
        self.known = {}

    def value(self, port):
        node, _, name = port.rpartition(".")
        if node not in self.known:
            with np.errstate(all="ignore"):
                self.known[node] = self.outputs(node)
        return self.known[node][name]

    def given(self, node, name):
        source = self.sources.get(f"{node}.{name}")
        return None if source is None else self.value(source)

    def outputs(self, node):
        module, p = self.nodes[node]["module"], self.nodes[node]["params"]
        inputs = ("image", "context", "magnitude", "phase", "pupil")
        given = {name: self.given(node, name) for name in inputs}
        if self.nodes[node].get("disabled"):
            return given
        if module in MAGNITUDE or module in PHASE:
            return spectral(module, p, **given)
        if module in PICTURES:
            return {"image": PICTURES[module](self, p, **given)}
        return getattr(self, module)(p, **given)

    def read_image(self, p, **_):
        samples = self.arrays[p["path"]]
        samples = samples * samples.dtype.type(p["scale"])
        intervals = [
            interval(samples, p[f"fov_{axis}_deg"], size)
            for axis, size in zip("xy", samples.shape[::-1], strict=True)
        ]
        band = (p["cut_on_um"], p["cut_off_um"]) if p["cut_on_um"] else None
        return {"image": Picture(samples, *intervals, band, float(np.abs(samples).max()))}

    def init_trans(self, p, image, **_):
        rows, columns = image.samples.shape
        x = interval(image.samples, p["fov_x_deg"], columns) or image.interval_x
        y = interval(image.samples, p["fov_y_deg"], rows) or image.interval_y
        context = {**p, "interval_x": x, "band_um": image.band_um}
        context["fill_x"], context["fill_y"] = p["fill_x"] or 1, p["fill_y"] or 1
        wire = Wire(image, (x, y, image.samples.shape), p["edges"])
        return {"context": context, "magnitude": wire, "phase": wire}

    def exit_pupil(self, p, **_):
        if p["shape"] != "file":
            return {"pupil": {**p, "samples": None}}
        samples = self.arrays[p["path"]]
        rows, columns = samples.shape
        lit = samples / samples.max()
        return {"pupil": {**p, "size_x": columns, "size_y": rows, "samples": lit}}

    def exit_pupil_mtf(self, p, context, magnitude, phase, pupil, **_):
        found = exit_pupil_mtf(p, context, pupil)
        if phase is None:
            phase = Wire(None, magnitude.grid, magnitude.edges)
        if found is None:
            return {"magnitude": magnitude, "phase": phase}
        modulus, turn = found
        if turn is not None:
            phase = phase.passed(turn, p)
        elif p["apply"] == "filter_only":
            phase = replace(phase, picture=None, laws=())
        return {"magnitude": magnitude.passed(modulus, p), "phase": phase}

    def back_transform(self, _, magnitude, phase, **_others):
        return {"image": back_transform(magnitude, phase)}


def interval(samples, fov_deg, size):
    return samples.dtype.type(fov_deg * PI / 180 * 1000 / size) if fov_deg else None


def spectral(module, p, context, magnitude, phase, **_):
    if module in PHASE:
        return {"phase": phase.passed(PHASE[module](p, context), p)}
    return {"magnitude": magnitude.passed(MAGNITUDE[module](p, context), p)}


def back_transform(magnitude, phase):
    ax, ay, shape = magnitude.grid
    bx, by, _ = phase.grid

    def transfer(xi, eta):
        h = np.ones(np.broadcast_shapes(xi.shape, eta.shape), (xi + 0j).dtype)
        for law in magnitude.laws:
            h *= law(xi, eta)
        for law in phase.laws:
            # Each wire has the frequencies of its own Init & Trans, sum by sum.
            h *= law(xi * ax / bx, eta * ay / by)
        return h

    one, other = magnitude.picture, phase.picture
    if one is not None and one is other and magnitude.edges == phase.edges:
        made = filtered(one.samples, transfer, (ax, ay), magnitude.edges)

        def between(*places):
            return filtered_at(one.samples, transfer, (ax, ay), magnitude.edges, places)

        return one.then(made, interval_x=ax, interval_y=ay, edges=magnitude.edges, between=between)
    samples, doubt = crossed(
        None if one is None else one.samples,
        None if other is None else other.samples,
        transfer,
        shape,
        (ax, ay),
    )
    like = one or other
    if like is None:
        scale = float(np.abs(samples).max())
        return Picture(samples, ax, ay, None, scale, edges="periodic")
    scale = one.scale if one else float(np.abs(samples).max())
    if other is not None and not doubt * other.scale <= LARGEST_DOUBT * scale:
        raise IllConditionedError
    decisions = sum((each.then(each.samples).decisions for each in (one, other) if each), ())
    made = replace(like, samples=samples, scale=scale, interval_x=ax, interval_y=ay)
    return replace(made, decisions=decisions, last=None, edges="periodic", between=None)


def combine_pixels(reference, p, image, **_):
    x, y = p["factor_x"], p["factor_y"]
    if x == y == 1:
        return image
    return image.then(
        resampling.combined(image.samples, x, y, p["mode"]),
        x * y if p["mode"] == "sum" else 1,
        interval_x=image.interval_x * x,
        interval_y=image.interval_y * y,
        edges=None if image.samples.shape[0] % y or image.samples.shape[1] % x else image.edges,
    )


def sample_pixels(reference, p, image, **_):
    x, y = p["factor_x"], p["factor_y"]
    offset_y = p["offset"] if p["offset_y"] is None else p["offset_y"]
    if (x, y, p["offset"], offset_y) == (1, 1, 0, 0):
        return image
    kind, (rows, columns) = image.samples.dtype.type, image.samples.shape
    places = (
        camera.pixel_places(rows, y, offset_y, kind),
        camera.pixel_places(columns, x, p["offset"], kind),
    )
    between = image.between
    if between is None:
        edges, one = image.edges or "reflect", np.ones(1, image.samples.dtype)[0]

        def between(*wanted):
            same = np.ones_like
            return filtered_at(
                image.samples, lambda xi, eta: same(xi) * same(eta) + 0j, (one, one), edges, wanted
            )

    whole = all(
        abs(len(place) * ratio - old) <= 1e-6 * ratio
        for place, ratio, old in zip(places, (y, x), (rows, columns), strict=True)
    )
    return image.then(
        between(*places),
        interval_x=image.interval_x * kind(x),
        interval_y=image.interval_y * kind(y),
        edges=image.edges if whole and not (p["offset"] or offset_y) else None,
    )


def interpolate(reference, p, image, **_):
    rows, columns = image.samples.shape
    width, height = p["width"] or columns, p["height"] or rows
    if (width, height) == (columns, rows):
        return image
    return image.then(
        resampling.interpolated(image.samples, width, height, p["order"], image.edges),
        interval_x=image.interval_x * columns / width,
        interval_y=image.interval_y * rows / height,
    )


def anti_alias(reference, p, image, **_):
    if p["factor"] == 1:
        return image
    return image.then(resampling.anti_aliased(image.samples, p["kernel"], p["factor"]))


def added(image, noise):
    return image.then(image.samples + noise, 1 + np.abs(noise).max() / (image.scale or 1))


def periodic_noise(reference, p, image, **_):
    if p["amplitude"] == 0:
        return image
    rows, columns = image.samples.shape
    intervals = image.interval_x, image.interval_y
    noise, radians = electronics.periodic_noise(p, rows, columns, *intervals)
    if abs(p["amplitude"]) * radians > LONGEST_PHASE * (image.scale + abs(p["amplitude"])):
        raise IllConditionedError
    return added(image, noise)


def noise_file(reference, p, image, **_):
    if p["scale"] == 0:
        return image
    noise = reference.arrays[p["path"]]
    return added(image, noise * noise.dtype.type(p["scale"]))


def electronics_noise(reference, p, image, context, **_):
    samples, gain = electronics.read_out(p, context, image.samples, image.interval_x, image.scale)
    shaped = image.then(samples, gain)
    if p["bits"] == 0:
        return shaped
    levels, distance, step = electronics.quantized(p, shaped.samples)
    return replace(shaped.then(levels), last=Decisions(distance, float(step), shaped.scale))


def focal_plane(reference, p, image, context, **_):
    made = camera.focal_plane(p, context, image.samples, image.scale)
    if made is None:
        raise IllConditionedError
    samples, scale = made
    return replace(image.then(samples, 0.0), scale=max(scale, float(np.abs(samples).max())))


def microbolometer(reference, p, image, context, **_):
    """Without noise, of one still frame: the lag along a scan alone."""
    velocity = context["scan_velocity_mrad_per_s"]
    if not velocity or not p["time_constant_s"]:
        return image
    lag = electronics.low_pass(np.longdouble(p["time_constant_s"]) * velocity)
    edges = context["edges"]
    return image.then(filtered_lines(image.samples, lag, image.interval_x, edges))


def as_it_is(reference, p, image, **_):
    """What adds noise, or takes it out, does nothing to a picture without any."""
    return image


PICTURES = {
    "sample_pixels": sample_pixels, "focal_plane": focal_plane, "microbolometer": microbolometer,
    "nuc": as_it_is, "noise_3d_source": as_it_is,
    "combine_pixels": combine_pixels, "interpolate": interpolate, "anti_alias": anti_alias,
    "periodic_noise": periodic_noise, "noise_file": noise_file,
    "electronics_noise": electronics_noise,
}  # fmt: skip
