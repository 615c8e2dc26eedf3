"""Pictures of simulated cameras by sums over a fine grid, with the true MTF, noise and edges.

Nothing of the product is imported. A scene's mean levels in cells much finer than the samples (see
`oversampled_scene`) are filtered on that grid and sampled; then come electrons, noise, gain,
quantizing, clipping and JPEG. Lengths are in samples, frequencies in cycles per sample, x across
and y down; the filter e^{−2πi f·shift} moves the picture by +shift.

    camera = Camera(cutoff=1.2, jitter=0.3, gain_e_per_dn=10, read_e=20, bits=12)
    frame = take(scene, camera, rows=128, columns=128, seed=3)
    frame.picture, frame.edges, true_mtf(camera, angle_deg, frequency), true_sigma(camera, level)
"""

import io
import math
from dataclasses import dataclass, replace

import numpy as np
from scipy import fft

from oversampled_scene import Fine, Scene, Shape, TrueEdge, render, true_edges


@dataclass(frozen=True)
class Camera:
    """What is between a scene in electrons a sample and a picture in DN; what is None or 0 is not.

    `cutoff` is the diffraction limit, 1 / (wavelength · F-number) in cycles per sample; `defocus`
    the wave aberration at the pupil's margin in waves; `electronics` the time constant of a
    low-pass along the rows (one pole, causal), in samples; `field_shift` what the scene moves
    across from the even rows to the odd ones; `periodic` an amplitude in DN, and cycles per sample
    across and down.
    """

    cutoff: float | None = None
    obscuration: float = 0.0
    defocus: float = 0.0
    gaussian: tuple[float, float] = (0.0, 0.0)
    jitter: float = 0.0
    motion: float = 0.0
    motion_deg: float = 0.0
    pixel: tuple[float, float] = (1.0, 1.0)
    electronics: float = 0.0
    field_shift: float = 0.0
    photons: bool = True
    read_e: float = 0.0
    gain_e_per_dn: float = 1.0
    offset_dn: float = 0.0
    row_dn: float = 0.0
    column_dn: float = 0.0
    periodic: tuple[float, float, float] = (0.0, 0.0, 0.0)
    bits: int | None = None
    jpeg_quality: int | None = None

    def dn(self, electrons):
        """The mean that many electrons give."""
        return electrons / self.gain_e_per_dn + self.offset_dn


@dataclass(frozen=True)
class Frame:
    """A picture, the same without noise and before quantizing, and the scene's true edges in DN."""

    picture: np.ndarray
    clean: np.ndarray
    edges: tuple[TrueEdge, ...]


def pupil_transfer(radius, obscuration=0.0, defocus=0.0, lines=1201):
    """Transfer function of an annular pupil out of focus, by a sum over its chords.

    `radius` is the frequency over the cutoff. The pupils, radius 1, are shifted by ±radius along x;
    on each chord y the difference of the wave aberration W (x² + y²) is 4 W radius x, whose
    integral over what both leave open is a difference of sines.
    """
    s = np.asarray(radius, float).ravel()[:, None, None]
    edges = np.linspace(0, math.pi / 2, lines)
    angle = (edges[1:] + edges[:-1]) / 2
    y, width = np.sin(angle), np.cos(angle) * np.diff(edges)
    outer = np.sqrt(1 - y**2)[:, None]
    half = np.maximum(outer - s, 0)[..., 0]
    rate = 2 * math.pi * defocus * 4 * s[..., 0]

    def upto(x):
        return x * np.sinc(rate * x / math.pi)

    total = 2 * upto(half)
    if obscuration:
        hole = np.sqrt(np.maximum(obscuration**2 - y**2, 0))[:, None]
        # The two holes are −s ± hole and s ± hole, both cut to the lens ± half.
        near, far = ((s - hole)[..., 0], (s + hole)[..., 0])
        near_cut = np.clip(near, -half, half)
        far_cut = np.clip(far, -half, half)
        one = upto(far_cut) - upto(near_cut)
        overlap = np.clip(-near, 0, half)  # where s < hole, both cover −(hole − s) … hole − s
        both = np.where(near < 0, 2 * upto(overlap), 0.0)
        total = total - 2 * one + both
    value = 2 * (total * width).sum(axis=1) / (math.pi * (1 - obscuration**2))
    return value.reshape(np.shape(radius))


def _along(camera, frequency, axis):
    """Factors of one axis: pixel, Gaussian, jitter, and electronics across."""
    blur = camera.gaussian[axis] ** 2 + camera.jitter**2
    factor = np.sinc(frequency * camera.pixel[axis]) * np.exp(-2 * math.pi**2 * blur * frequency**2)
    if axis == 0 and camera.electronics:
        factor = factor / (1 + 2j * math.pi * frequency * camera.electronics)
    return factor


def _joint(camera, fx, fy):
    """Factors of both axes together: optics and motion, or None."""
    factor = None
    if camera.cutoff is not None:
        table = np.linspace(0, 1, 801)
        values = pupil_transfer(table, camera.obscuration, camera.defocus)
        reduced = np.hypot(fx, fy) / camera.cutoff
        factor = np.interp(reduced, table, values, right=0.0)
    if camera.motion:
        angle = math.radians(camera.motion_deg)
        moved = np.sinc(camera.motion * (fx * math.cos(angle) + fy * math.sin(angle)))
        factor = moved if factor is None else factor * moved
    return factor


def transfer(camera, fx, fy):
    """Complex transfer function of everything up to the sampling, pixel included."""
    fx, fy = np.broadcast_arrays(np.asarray(fx, float), np.asarray(fy, float))
    both = _joint(camera, fx, fy)
    product = _along(camera, fx, 0) * _along(camera, fy, 1)
    return product if both is None else product * both


def true_mtf(camera, angle_deg, frequency):
    """MTF along a normal `angle_deg` from x towards y."""
    frequency = np.asarray(frequency, float)
    angle = math.radians(angle_deg)
    return np.abs(transfer(camera, frequency * math.cos(angle), frequency * math.sin(angle)))


def true_spread(camera, angle_deg, distance, *, step=1 / 512, last=8.0):
    """Spread of an endless straight edge from 0 to 1, by the midpoint rule over frequency."""
    frequency = np.arange(step / 2, last if camera.cutoff is None else camera.cutoff, step)
    angle = math.radians(angle_deg)
    value = transfer(camera, frequency * math.cos(angle), frequency * math.sin(angle))
    turn = 2 * math.pi * np.multiply.outer(np.asarray(distance, float), frequency)
    weight = step / (math.pi * frequency)
    return 0.5 + np.sin(turn) @ (value.real * weight) + np.cos(turn) @ (value.imag * weight)


def true_sigma(camera, electrons):
    """Standard deviation of a sample about its row's and column's mean, in DN, at a level.

    Shot, read and quantizing noise; what rows, columns and periodic lines add is their own.
    """
    shot = electrons if camera.photons else 0.0
    quantum = 0.0 if camera.bits is None else 1 / 12
    return np.sqrt((shot + camera.read_e**2) / camera.gain_e_per_dn**2 + quantum)


def sampled(fine, camera):
    """The filtered scene at the samples in the frame: filtered on the cells, then each K-th."""
    count = fine.level.shape
    fy = fft.fftfreq(count[0], 1 / fine.fine)[:, None]
    fx = fft.rfftfreq(count[1], 1 / fine.fine)
    # A cell is the scene's mean over it: divided out. From a cell's middle to the sample's.
    place = 0.5 - 0.5 / fine.fine
    across, down = (
        _along(camera, f, axis) / np.sinc(f / fine.fine) * np.exp(2j * math.pi * f * place)
        for axis, f in ((0, fx), (1, fy))
    )
    spectrum = fft.rfft2(fine.level)
    if camera.cutoff is not None:  # beyond it there is nothing: fewer values to compute
        within = np.flatnonzero(np.abs(fy[:, 0]) <= camera.cutoff)
        last = np.searchsorted(fx, camera.cutoff)
        passed = np.zeros_like(spectrum)
        passed[within, :last] = spectrum[within, :last]
        passed[within, :last] *= _joint(camera, fx[:last], fy[within])
        spectrum = passed
    elif camera.motion:
        spectrum *= _joint(camera, fx, fy)
    spectrum *= down
    # Every K-th row is the sum over the K repetitions of the spectrum down.
    folded = spectrum.reshape(fine.fine, -1, fx.size).sum(axis=0) / fine.fine
    rows = fft.ifft(folded, axis=0)
    picture = fft.irfft(rows * across, count[1], axis=1)[:, :: fine.fine]
    return picture[fine.margin : -fine.margin, fine.margin : -fine.margin]


def sampled_fields(fine, camera):
    """As `sampled`, the odd rows from a scene that moved on."""
    picture = sampled(fine, camera)
    if camera.field_shift:
        cells = round(camera.field_shift * fine.fine)
        later = Fine(np.roll(fine.level, cells, axis=1), fine.fine, fine.margin)
        picture[1::2] = sampled(later, camera)[1::2]
    return picture


def digitized(electrons, camera, seed):
    """Mean electrons a sample with noise, gain, quantizing, clipping and JPEG, in DN."""
    rng = np.random.default_rng([seed, 1])
    shape = electrons.shape
    signal = rng.poisson(electrons.clip(0)).astype(float) if camera.photons else electrons
    signal = signal + camera.read_e * rng.standard_normal(shape)
    picture = camera.dn(signal)
    picture += camera.row_dn * rng.standard_normal((shape[0], 1))
    picture += camera.column_dn * rng.standard_normal(shape[1])
    amplitude, across, down = camera.periodic
    if amplitude:
        y, x = np.indices(shape)
        start = rng.random()
        picture += amplitude * np.cos(2 * math.pi * (across * x + down * y + start))
    if camera.bits is not None:
        picture = np.rint(picture).clip(0, 2**camera.bits - 1)
    return picture if camera.jpeg_quality is None else _jpeg(picture, camera.jpeg_quality)


def _jpeg(picture, quality):
    from PIL import Image

    file = io.BytesIO()
    Image.fromarray(picture.clip(0, 255).astype(np.uint8)).save(file, "jpeg", quality=quality)
    return np.asarray(Image.open(file), float)


def take(scene, camera, *, rows, columns, seed=0, fine=8, margin=24, reach=8.0):
    """A frame of a scene by a camera; the scene's levels are electrons a sample."""
    cells = render(scene, rows, columns, fine=fine, margin=margin)
    clean = sampled_fields(cells, camera)
    edges = tuple(
        replace(edge, low=float(camera.dn(edge.low)), high=float(camera.dn(edge.high)))
        for edge in true_edges(scene, cells, rows, columns, reach=reach)
    )
    return Frame(digitized(clean, camera, seed), camera.dn(clean), edges)


def half_plane(angle_deg, through, low, high, *, size=1e4):
    """A scene of one endless edge; the normal points to the brighter side."""
    angle = math.radians(angle_deg)
    normal = np.array([math.cos(angle), math.sin(angle)])
    along = np.array([-normal[1], normal[0]]) * size
    at = np.asarray(through, float)
    corners = np.array(
        [at - along, at + along, at + along + normal * size, at - along + normal * size]
    )
    return Scene(background=low, shapes=(Shape(corners, high),))
