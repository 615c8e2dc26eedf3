"""Noise of single pictures of random cameras against the truth; run by hand.

    python tests/fuzz/noise_cameras.py [FIRST [COUNT]]

Scenes of polygons, bars, 1/f texture, both, and shading; 8 to 14 bits, optics from blurred to
undersampled, and in every third camera rows, columns or a periodic line with noise of their own.
Prints a line of a camera where a figure is off by more than three of its errors, then how often
sigma lies within 3 %, gain within 5 %, and both within one and three of their standard errors.
"""

from __future__ import annotations

import math
import sys
import warnings
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT / "tests/support"), str(ROOT)]

from core.physics.measurement.noise.picture_noise import noise_of_picture  # noqa: E402
from oversampled_camera import Camera, take, true_sigma  # noqa: E402
from oversampled_scene import Scene, Shape  # noqa: E402

ROWS, COLUMNS = 256, 320
KINDS = ("polygons", "bars", "texture", "mixed", "shading")


def rectangle(x, y, half_width, half_height, angle):
    """Corners of a turned rectangle."""
    along = np.array([math.cos(angle), math.sin(angle)])
    across = np.array([-along[1], along[0]])
    signs = ((-1, -1), (1, -1), (1, 1), (-1, 1))
    return np.array([[x, y] + s * half_width * along + t * half_height * across for s, t in signs])


def scene_of(random, kind, full, seed):
    """A scene whose levels are electrons of a sample, up to `full`."""
    shapes, texture, power, shading = [], 0.0, 2.0, (0.0, 0.0)
    if kind in ("polygons", "mixed"):
        for _ in range(random.integers(3, 12)):
            corners = rectangle(
                random.uniform(0, COLUMNS),
                random.uniform(0, ROWS),
                *random.uniform(15, 90, 2),
                random.uniform(0, 3),
            )
            own = float(random.choice([0, 0, 0.05])) if kind == "mixed" else 0.0
            shapes.append(Shape(corners, full * random.uniform(0.01, 0.95), True, own))
    if kind == "bars":
        period, angle = random.uniform(6, 40), random.uniform(0, math.pi)
        level, half = full * random.uniform(0.1, 0.9), random.uniform(60, 160)
        for place in np.arange(-240, 241, period):
            x, y = COLUMNS / 2 + place * math.cos(angle), ROWS / 2 + place * math.sin(angle)
            shapes.append(Shape(rectangle(x, y, period / 4, half, angle), level))
    if kind in ("texture", "mixed"):
        texture, power = float(10 ** random.uniform(-2, -0.7)), float(random.choice([2, 2.5, 3]))
    if kind == "shading":
        shading = tuple(random.uniform(-0.2, 0.2, 2))
    return Scene(
        background=full * random.uniform(0.03, 0.6),
        shapes=tuple(shapes),
        texture=texture,
        texture_power=power,
        texture_seed=seed,
        shading=shading,
    )


def drawn(seed):
    """Kind of scene, scene and camera of a seed."""
    random = np.random.default_rng([seed, 1996])
    kind = KINDS[seed % len(KINDS)]
    bits = int(random.choice([8, 10, 12, 14]))
    well = 10 ** random.uniform(3.7, 5.3)
    offset = float(random.choice([0, 0, 5, 64 if bits > 8 else 10]))
    gain = well / (2**bits - 1 - offset)
    read = max(10 ** random.uniform(0.3, 2), 0.3 * gain)
    typical = math.sqrt(0.3 * well + read**2) / gain
    extra = {}
    if seed % 3 == 0:
        extra["row_dn"] = typical * float(random.choice([0, random.uniform(0.1, 1)]))
        extra["column_dn"] = typical * float(random.choice([0, random.uniform(0.1, 1)]))
        amplitude = typical * float(random.choice([0, random.uniform(0.2, 2)]))
        extra["periodic"] = (amplitude, random.uniform(0.1, 0.45), random.uniform(-0.45, 0.45))
    camera = Camera(
        cutoff=float(random.uniform(0.6, 2.5)),
        jitter=float(random.uniform(0, 0.5)),
        gaussian=(float(random.uniform(0, 0.5)),) * 2,
        pixel=(float(random.uniform(0.7, 1)),) * 2,
        read_e=read,
        gain_e_per_dn=gain,
        offset_dn=offset,
        bits=bits,
        **extra,
    )
    return kind, scene_of(random, kind, 0.9 * well, seed), camera


def main(first=0, count=240):
    """Measure `count` cameras and print how far off they are."""
    figures = {}
    for seed in range(first, first + count):
        kind, scene, camera = drawn(seed)
        frame = take(scene, camera, rows=ROWS, columns=COLUMNS, seed=seed, fine=6, margin=16)
        noise = noise_of_picture(picture=frame.picture, offset=camera.offset_dn)
        electrons = max(0.0, (noise.mean_level - camera.offset_dn) * camera.gain_e_per_dn)
        sigma = float(true_sigma(camera, electrons))
        gain, read = camera.gain_e_per_dn, camera.read_e / camera.gain_e_per_dn
        rows = [
            ("sigma", noise.sigma, noise.sigma_error, sigma),
            ("gain", noise.gain_e_per_dn, noise.gain_error, gain),
            ("read noise", noise.read_noise_dn, noise.read_noise_error, read),
        ]
        if noise.sigma is not None:
            for name, part, truth in (
                ("rows", noise.rows, camera.row_dn),
                ("columns", noise.columns, camera.column_dn),
            ):
                if part is not None:
                    rows.append((name, part.variance, part.variance_error, truth**2))
            amplitude, across, down = camera.periodic
            seen = [
                line
                for line in noise.lines
                if abs(line.across - across) < 0.5 / COLUMNS and abs(line.down - down) < 0.5 / ROWS
            ]
            false = len(noise.lines) - len(seen)
            figures.setdefault("lines that are none", []).append((False, float(false), 0.0))
            if amplitude > 0.2 * sigma:
                figures.setdefault("lines missed", []).append((False, float(not seen), 0.0))
                if seen:
                    rows.append(
                        ("amplitude", seen[0].amplitude, seen[0].amplitude_error, amplitude)
                    )
        for name, value, error, truth in rows:
            off = None if value is None else (value / truth - 1.0 if truth else 0.0)
            pull = None if value is None else (value - truth) / max(error, 1e-300)
            figures.setdefault(name, []).append((value is None, off, pull))
            if pull is not None and abs(pull) > 3.0:
                print(f"{seed} {kind}: {name} {value:.4g} ± {error:.2g}, true {truth:.4g}")
    for name, measured in figures.items():
        off, pulls = (np.array([m[k] for m in measured if not m[0]]) for k in (1, 2))
        if name.startswith("lines"):
            print(f"{name}: {off.sum():.0f} in {len(off)}")
            continue
        near, far = (np.mean(abs(pulls) < limit) for limit in (1, 3))
        print(
            f"{name}: {len(off)} of {len(measured)} given, within 3 % "
            f"{np.mean(abs(off) < 0.03):.3f}, 5 % {np.mean(abs(off) < 0.05):.3f}, worst "
            f"{abs(off).max():.3f}; within 1 error {near:.3f}, 3 errors {far:.3f}"
        )


if __name__ == "__main__":
    warnings.simplefilter("error")
    main(*map(int, sys.argv[1:3]))
