"""3-D Noise: predicted, simulated and in files."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image as Pillow

from core.chain.random_fields import at_frame
from core.network.network import Link, Node
from core.physics.noise.noise_components import COMPONENTS, NoiseCube
from node_bench import NodeBench
from nodes.analysis.lineage import NoiseOf, noise_free
from noisy_sensors import SOURCES, noisy_sensor, picture_of

ALL = ("photons", "gain", "bias", "detector", "amplifier", "quantization", "periodic")


def measured(folder, kinds, frames=200, seed=11, **settings):
    """The node behind a sensor with these noises."""
    _, network = noisy_sensor(folder, *kinds, **settings)
    node = Node("noise", "noise_3d", {"frames": frames})
    network = replace(
        network,
        seed=seed,
        nodes={**network.nodes, "noise": node},
        links=(*network.links, Link.between("out.image", "noise.image")),
    )
    return NodeBench(folder, network)


@pytest.mark.parametrize("kinds", [("photons",), ("detector",), ("amplifier", "quantization"), ALL])
def test_temporal_noise_of_200_frames(tmp_path, kinds):
    """Within four of the standard errors told, each widened by its neighbours' correlation.

    White noise of these chains is filtered to no less than a tenth of its samples' number, which
    widens standard errors by at most √10; the components beside tvh hang on few averages.
    """
    table = measured(tmp_path, kinds).value("noise.table").as_dict()
    for name in ("tvh", "tv", "th", "t"):
        off = table[f"sigma_{name}_measured"] - table[f"sigma_{name}"]
        assert abs(off) < 4 * np.sqrt(10) * table[f"sigma_{name}_error"], name


def test_fixed_pattern_of_one_sensor(tmp_path):
    """Detectors of a staring array: 60 × 48 deviates tell σ to 1/√(2·2880) = 1.3 %."""
    bench = measured(tmp_path, ("gain", "bias"), frames=2, resize=False)
    table = bench.value("noise.table").as_dict()
    assert table["fixed_measured"] == pytest.approx(table["fixed"], rel=4 * 0.014)
    # What sums of squares of doubles leave of the pattern where nothing changes: the root of 1e-16.
    assert table["temporal_measured"] < 1e-7 * table["fixed"]
    assert table["temporal"] < 1e-9


def test_a_single_frame_is_refused(tmp_path):
    bench = measured(tmp_path, (), frames=1)
    assert [str(error) for error in bench.plan.errors()] == [
        "noise: frames = 1 is not allowed: must be 0, or at least 2"
    ]


KINDS = ("photons", "published photons", *SOURCES, "periodic")
SENSORS, FRAMES_OF_EACH = 20, 10
SETTINGS = {
    "staring": {"platform": "array"},
    "pushbroom": {"platform": "push", "edges": "periodic", "resize": False},
    "scanner": {"platform": "line", "factor": 5},
}


def simulated(folder, kinds, **settings):
    """Estimates of 20 sensors with 10 frames each, and the prediction for the last sensor."""
    engine, network = noisy_sensor(folder, *kinds, **settings)
    found = []
    for seed in range(SENSORS):
        image, work = picture_of(engine, network, folder, seed)
        clean = work.value(noise_free(image.recipe))
        cube = NoiseCube(*image.shape)
        for frame in range(FRAMES_OF_EACH):
            cube.add(work.value(at_frame(image.recipe, frame)) - clean)
        variances = cube.measured().variances
        found.append([variances.variance(name) for name in COMPONENTS])
    total = work.value(NoiseOf(image)).total
    return np.array(found), np.array([total.variance(name) for name in COMPONENTS])


@pytest.mark.thorough(but=14)
@pytest.mark.parametrize("setting", SETTINGS)
@pytest.mark.parametrize("kinds", [*((kind,) for kind in KINDS), ALL], ids=[*KINDS, "all"])
def test_prediction_is_the_mean_of_estimates(tmp_path, setting, kinds):
    """Within four standard errors of 200 frames, which the sensors' own scatter tells.

    The samples, of 30, are rounded to 2^−48 in each step: below 1e−14 squared nothing is told.
    """
    found, predicted = simulated(tmp_path, kinds, **SETTINGS[setting])
    error = found.std(axis=0, ddof=1) / np.sqrt(SENSORS)
    largest = predicted.max()
    off = np.abs(found.mean(axis=0) - predicted)
    assert np.all(off < 4.0 * error + 1e-9 * largest + 1e-28), dict(
        zip(COMPONENTS, zip(found.mean(axis=0), predicted, error, strict=True), strict=True)
    )
    assert largest > 0 or (setting, kinds) == ("scanner", ("bias",))


def test_each_source_has_its_term(tmp_path):
    image, work = picture_of(*noisy_sensor(tmp_path, *ALL), tmp_path, 1)
    noise = work.value(NoiseOf(image))
    told = {(term.node, term.name): term for term in noise.terms}
    assert [(t.node, t.name, t.temporal) for t in noise.terms] == [
        ("photons", "photons", True),
        ("periodic", "periodic", False),
        ("electronics", "gain", False),
        ("electronics", "bias", False),
        ("electronics", "detector", True),
        ("electronics", "amplifier", True),
        ("electronics", "quantization", True),
        ("electronics", "quantization", False),
    ]
    assert noise.mean == pytest.approx(30.0, rel=0.01)
    assert noise.unknown == ()
    summed = sum(term.variances.total for term in noise.terms)
    assert noise.total.total == pytest.approx(summed)
    # 8 levels of noise stir a step of 80/63 fully: q²/12, less what interpolation averages.
    stirred = told["electronics", "quantization"].variances
    assert stirred.total == 0.0 or stirred.total < (80 / 63) ** 2 / 12


SIGMAS = {"tvh": 9.0, "vh": 6.0, "v": 3.0, "h": 4.0, "t": 2.0, "tv": 2.5, "th": 1.5}
FRAMES, ROWS, COLUMNS = 150, 80, 120


def drawn(seed=4):
    """Frames that are sums of seven independent fields about a level of 5000."""
    random = np.random.default_rng(seed)
    sizes = {"t": FRAMES, "v": ROWS, "h": COLUMNS}
    cube = np.full((FRAMES, ROWS, COLUMNS), 5000.0)
    for name, sigma in SIGMAS.items():
        shape = [sizes[axis] if axis in name else 1 for axis in "tvh"]
        cube += sigma * random.standard_normal(shape)
    return cube


def write(folder, name, cube):
    path = folder / name
    if name.endswith(".npy"):
        np.save(path, cube.astype(np.float32))
    elif name.endswith(".tif"):
        first, *others = (Pillow.fromarray(one) for one in cube.astype(np.float32))
        first.save(path, save_all=True, append_images=others)
    else:
        cube.astype("<f4").tofile(path)
        frames, rows, columns = cube.shape
        path.with_name(f"{name}.hdr").write_text(
            f"ENVI\nsamples = {columns}\nlines = {rows}\nbands = {frames}\ndata type = 4\n"
            "interleave = bsq\nbyte order = 0\ndata units = DN\n"
        )


def planned(folder, params, *, image=None):
    nodes = {} if image is None else {"scene": ("read_image", image)}
    return NodeBench(folder, {**nodes, "noise": ("noise_3d", params)}, precision="single")


def table(folder, params, **how):
    return planned(folder, params, **how).value("noise.table")


@pytest.mark.parametrize("name", ["f.npy", "f.tif", "f.bsq"])
def test_components_of_a_file(tmp_path, name):
    """Within four standard errors: σ²·√(2/degrees of freedom) of each component's own average."""
    write(tmp_path, name, drawn())
    made = table(tmp_path, {"path": name})
    figures = made.as_dict()
    free = {"t": FRAMES - 1, "v": ROWS - 1, "h": COLUMNS - 1}
    sizes = {"t": FRAMES, "v": ROWS, "h": COLUMNS}
    for component, sigma in SIGMAS.items():
        # A mean square is of the components that contain its axes, each over what it averages.
        square = sum(
            other**2 * np.prod([sizes[axis] for axis in sizes if axis not in within], initial=1.0)
            for within, other in SIGMAS.items()
            if set(component) <= set(within)
        ) / np.prod([sizes[axis] for axis in sizes if axis not in component], initial=1.0)
        error = square * np.sqrt(2.0 / np.prod([free[axis] for axis in component]))
        measured = figures[f"sigma_{component}_measured"]
        assert abs(measured**2 - sigma**2) < 4 * 1.5 * error, component
    assert figures["mean"] == pytest.approx(5000.0, abs=4 * np.hypot(2 / 12, 0.6))
    assert figures["frames"] == FRAMES
    assert {row.unit for row in made.rows} == {"DN" if name == "f.bsq" else "", ""}
    assert f"sigma_{COMPONENTS[0]}" not in figures


def test_what_is_refused(tmp_path):
    cube = drawn()[:3]
    for name in ("f.npy", "f.bsq"):
        write(tmp_path, name, cube)
    np.save(tmp_path / "one.npy", cube[0])
    np.save(tmp_path / "small.npy", cube[0, :7])

    def line(params, **how):
        (error,) = planned(tmp_path, params, **how).plan.errors()
        return str(error).replace(f"{tmp_path}/", "")

    assert line({}) == (
        "noise: path is empty: give a file of frames, or connect a picture to image"
    )  # fmt: skip
    assert line({"path": "none.npy"}) == "noise: none.npy: no such file"
    assert line({"path": "one.npy"}) == (
        "noise: one.npy has only one frame; temporal noise needs 2 or more"
    )
    assert line({"path": "f.npy"}, image={"path": "small.npy"}) == (
        "noise: f.npy: frames of 80 × 120 samples, but the connected picture "
        "has 7 × 120: connect a picture from the same camera, or no picture"
    )
    assert line({"path": "f.bsq"}, image={"path": "one.npy", "unit": "K"}) == (
        "noise: f.bsq: frames in 'DN', but the connected picture is in 'K': "
        "connect a picture in the same unit, or no picture"
    )
