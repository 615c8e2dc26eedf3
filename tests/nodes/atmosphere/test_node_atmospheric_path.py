"""Atmospheric Path, and a warm window."""

import math

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad

from core.errors import ImagechainError
from node_bench import NodeBench
from nodes.analysis.lineage import NoiseOf
from planck_truth import band_radiance
from reference_cases import CAMERA, reference_cases

FOV = {"fov_x_deg": 1.0, "fov_y_deg": 1.0}
LWIR = {"cut_on_um": 8.0, "cut_off_um": 12.0}
SAMPLES = np.array([[21.0, 35.5, 40.0], [38.0, 60.0, 33.3]])


class Chain(NodeBench):
    """Read Image, then modules in their order, planned and evaluated in double precision."""

    def __init__(self, folder, samples, read, *nodes):
        np.save(folder / "in.npy", samples)
        table = {name: (key, params) for name, key, params in nodes}
        read = ("read_image", {"path": "in.npy", **FOV, **read})
        super().__init__(folder, {"read": read, **table})

    def figures(self, node="air"):
        return self.readouts(node)

    def table(self):
        return self.value("air.table").as_dict()

    def warnings(self):
        return [str(caution) for caution in self.plan.warnings()]


@pytest.fixture
def chain(tmp_path):
    def made(params, *, samples=SAMPLES, read=LWIR, before=()):
        nodes = (*before, ("air", "atmospheric_path", params))
        return Chain(tmp_path, samples, read, *nodes)

    return made


@pytest.mark.parametrize("case", reference_cases("transmission", file=CAMERA))
def test_published_transmissions(case, chain):
    inputs = case["inputs"]
    known = chain({
        "model": "visibility_km", "visibility_km": float(inputs["visibility_km"]),
        "range_m": 1000 * float(inputs["range_km"]),
    })  # fmt: skip
    expected = float(case["expected"]["transmission"])
    assert known.figures()["transmission"] == pytest.approx(expected, rel=1e-9)
    assert known.figures()["optical_depth"] == pytest.approx(-math.log(expected), rel=1e-9)
    np.testing.assert_allclose(known.value("air.image"), expected * SAMPLES, rtol=1e-9)


@pytest.mark.parametrize("case", reference_cases("at_sensor_radiance", file=CAMERA))
@pytest.mark.parametrize("kelvin", [True, False])
def test_published_radiances_at_the_sensor(case, kelvin, chain):
    """Of a scene in kelvin by To Radiance, and of its radiance."""
    inputs = {name: float(value) for name, value in case["inputs"].items()}
    band = {name: inputs[name] for name in ("cut_on_um", "cut_off_um")}
    target = inputs["target_K"] if kelvin else band_radiance(*band.values(), inputs["target_K"])
    known = chain(
        {"transmission": inputs["transmission"], "air_K": inputs["air_K"]},
        samples=np.full((2, 3), float(target)),
        read={**band, "unit": "K" if kelvin else "W/m²/sr"},
        before=[("to", "to_radiance", {})] if kelvin else [],
    )
    expected = float(case["expected"]["radiance_W_per_m2_sr"])
    np.testing.assert_allclose(known.value("air.image"), expected, rtol=1e-9)
    assert known.warnings() == []


def test_visibility_by_wavelength_weighted_by_the_scene(chain):
    """∫τ·L_λ(T) over ∫L_λ(T), T the brightness temperature of the picture's mean."""
    scene = np.full((4, 4), band_radiance(3, 5, 305))
    params = {"model": "visibility_km", "visibility_km": 5, "angstrom_q": 1.3, "range_m": 3000}
    known = chain(params, samples=scene, read={"cut_on_um": 3.0, "cut_off_um": 5.0})

    def passed(um):
        power = mpmath.mpf("1.3")
        return mpmath.exp(-mpmath.mpf("3.912") / 5 * 3 * (mpmath.mpf("0.55") / um) ** power)

    def planck(um, kelvin=305):
        return um**-5 / mpmath.expm1(mpmath.mpf("14387.768775039338") / (um * kelvin))

    def mean(kelvin):
        top = mpmath.quad(lambda um: passed(um) * planck(um, kelvin), [3, 4, 5])
        return float(top / mpmath.quad(lambda um: planck(um, kelvin), [3, 4, 5]))

    assert known.figures()["transmission"] == pytest.approx(mean(305), rel=1e-10)
    assert known.table()["weighted_by_K"] == pytest.approx(305, rel=1e-10)
    at_four = known.table()["transmission_4_um"]
    assert at_four == pytest.approx(float(passed(mpmath.mpf(4))), rel=1e-12)
    hot = chain({**params, "source_K": 1200}, samples=scene, read={"cut_on_um": 3, "cut_off_um": 5})
    assert hot.figures()["transmission"] == pytest.approx(mean(1200), rel=1e-10)
    assert mean(1200) < mean(305)
    visible = chain(params, samples=scene, read={"cut_on_um": 0.4, "cut_off_um": 0.7})
    assert visible.table()["weighted_by_K"] == 5800.0


def test_scattering_alone_has_its_plateau_and_dims_the_mean(tmp_path):
    samples = np.random.default_rng(4).uniform(20, 60, (12, 16))
    path = {"model": "extinction_per_km", "extinction_per_km": 0.35, "range_m": 2000.0}
    known = Chain(
        tmp_path, samples, LWIR,
        ("air", "atmospheric_path", path),
        ("init", "init_trans", {"range_m": 2000.0}),
        ("blur", "atmosphere_mtf", {"turbidity": "custom", "scattering_per_km": 0.35}),
        ("back", "back_transform", {}),
    )  # fmt: skip
    mtf = known.value("blur.mtf").ravel()
    assert mtf[0] == 1.0
    np.testing.assert_allclose(mtf[1:], math.exp(-0.7), rtol=1e-13)
    made = known.value("back.image")
    assert made.mean() == pytest.approx(math.exp(-0.7) * samples.mean(), rel=1e-12)
    contrast = made - made.mean()
    expected = math.exp(-1.4) * (samples - samples.mean())
    np.testing.assert_allclose(contrast, expected, atol=1e-10)


def test_a_file_of_transmission_and_one_with_path_radiance(chain, tmp_path):
    (tmp_path / "tau.csv").write_text("um,transmission\n7,0.5\n13,0.5\n")
    known = chain({"path": "tau.csv", "air_K": 290})
    added = 0.5 * band_radiance(8, 12, 290)
    np.testing.assert_allclose(known.value("air.image"), 0.5 * SAMPLES + added, rtol=1e-12)
    (tmp_path / "lut.csv").write_text("7,0.25,1.5\n13,0.25,1.5\n")
    known = chain({"model": "modtran", "path": "lut.csv"})
    np.testing.assert_allclose(known.value("air.image"), 0.25 * SAMPLES + 6.0, rtol=1e-12)
    assert known.figures()["path_radiance"] == pytest.approx(6.0, rel=1e-12)
    assert known.table()["path_radiance_10_um"] == pytest.approx(1.5, rel=1e-14)


def test_the_range_of_the_camera_or_of_the_context(chain):
    params = {"model": "extinction_per_km", "extinction_per_km": 0.1}
    known = chain(params, before=[("cam", "camera", {"range_m": 3000})])
    assert known.figures()["optical_depth"] == pytest.approx(0.3, rel=1e-14)
    known = chain(params, before=[("init", "init_trans", {"range_m": 4000})])
    assert known.figures()["optical_depth"] == pytest.approx(0.4, rel=1e-14)
    known = chain({**params, "range_m": 5000}, before=[("cam", "camera", {"range_m": 3000})])
    assert known.figures()["optical_depth"] == pytest.approx(0.5, rel=1e-14)
    assert any("range_m = 5000 m here but 3000 m on Camera" in text for text in known.warnings())


def test_noise_of_the_scene_is_dimmed(tmp_path):
    """Noise before the path falls with the transmission, noise behind it does not."""
    known = Chain(
        tmp_path, np.full((16, 16), 40.0), LWIR,
        ("scene_noise", "noise_3d_source", {"sigma_tvh": 2.0}),
        ("air", "atmospheric_path", {"transmission": 0.25, "air_K": 280}),
        ("own_noise", "noise_3d_source", {"sigma_tvh": 3.0}),
    )  # fmt: skip
    image = known.plan.output("own_noise.image")
    first, second = known.work.value(NoiseOf(image, "own_noise")).terms
    assert first.variances.total == pytest.approx(0.5**2, rel=1e-12)
    assert second.variances.total == pytest.approx(3.0**2, rel=1e-12)
    assert len(image.air) == 1


def test_two_constituents(chain, tmp_path):
    known = chain(
        {"transmission": 0.5, "air_K": 280, "range_m": 700},
        before=[("gas", "atmospheric_path", {"transmission": 0.8, "air_K": 280, "range_m": 900})],
    )
    expected = 0.4 * SAMPLES + 0.6 * band_radiance(8, 12, 280)
    np.testing.assert_allclose(known.value("air.image"), expected, rtol=1e-12)
    assert len(known.plan.output("air.image").air) == 2
    assert any(
        "range_m = 700 m here but 900 m on the Atmospheric Path" in w for w in known.warnings()
    )


@pytest.mark.parametrize(
    ("params", "read", "words"),
    [
        ({"transmission": 1.5}, {}, ("transmission = 1.5", "from 0 to 1")),
        ({"transmission": -0.1}, {}, ("transmission = -0.1", "from 0 to 1")),
        ({"model": "visibility_km", "visibility_km": 0, "range_m": 1}, {},
         ("visibility_km = 0", "above 0")),
        ({"model": "visibility_km"}, {}, ("range_m is empty", "after a Camera")),
        ({"model": "extinction_per_km"}, {}, ("range_m is empty", "after a Camera")),
        ({"model": "modtran"}, {}, ("path is empty", "tape7")),
        ({"path": "short.csv"}, {}, ("9 to 11 µm", "Give a table that covers 8 to 12 µm")),
        ({"path": "wrong.csv"}, {}, ("line 2", "transmission from 0 to 1")),
        ({"path": "none.csv"}, {}, ("none.csv: no such file",)),
        ({"transmission": 0.5}, {"unit": "K"}, ("'K'", "is a temperature", "To Radiance")),
        ({"transmission": 0.5}, {"unit": "DN"}, ("'DN'", "not the radiance of a band")),
        ({"transmission": 0.5}, {"unit": " "}, ("without a unit", "not the radiance of a band")),
        ({"transmission": 0.5}, {"unit": "W/m²/sr/µm"}, ("not the radiance of a band",)),
        ({"transmission": 0.5, "air_K": 280}, {"cut_on_um": None, "cut_off_um": None},
         ("the image has no band", "cut_on_um")),
    ],
)  # fmt: skip
def test_bad_input_is_one_clear_line(params, read, words, chain, tmp_path):
    (tmp_path / "short.csv").write_text("9,0.5\n11,0.6\n")
    (tmp_path / "wrong.csv").write_text("8,0.5\n12,1.6\n")
    try:
        (error,) = chain(params, read={**LWIR, **read}).plan.errors()
    except ImagechainError as refused:
        error = refused
    for word in words:
        assert word in str(error)
    assert "\n" not in str(error)


def test_a_dark_picture_has_no_temperature(chain):
    params = {"model": "visibility_km", "angstrom_q": 1, "range_m": 100}
    known = chain(params, samples=np.zeros((2, 2)))
    with pytest.raises(ImagechainError, match=r"mean radiance 0 W/m²/sr.*give source_K"):
        known.value("air.image")
    known = chain({**params, "source_K": 300}, samples=np.zeros((2, 2)))
    np.testing.assert_array_equal(known.value("air.image"), 0.0)


@pytest.mark.parametrize(
    ("params", "words"),
    [
        ({"path": "tau.csv", "transmission": 0.3}, "transmission = 0.3 is not used"),
        ({"model": "modtran", "path": "lut.csv", "air_K": 280}, "air_K = 280 K is not used"),
        ({"model": "visibility_km", "path": "tau.csv", "range_m": 9}, "path is not used"),
    ],
)
def test_what_is_not_used_is_a_warning(params, words, chain, tmp_path):
    (tmp_path / "tau.csv").write_text("7,0.5\n13,0.5\n")
    (tmp_path / "lut.csv").write_text("7,0.25,1.5\n13,0.25,1.5\n")
    (warned,) = (text for text in chain(params).warnings() if "not used" in text)
    assert words in warned


def test_light_of_the_air_is_no_signal(tmp_path):
    """SNR of Image Quality: half of 10 over a noise of 0.1; the air's 0.6 is no scene."""
    (tmp_path / "lut.csv").write_text("0.4,0.5,2\n0.9,0.5,2\n")
    known = Chain(
        tmp_path, np.full((16, 16), 10.0), {"cut_on_um": 0.5, "cut_off_um": 0.8},
        ("air", "atmospheric_path", {"model": "modtran", "path": "lut.csv", "range_m": 3000}),
        ("init", "init_trans", {"range_m": 3000}),
        ("noise", "noise_3d_source", {"sigma_tvh": 0.1}),
        ("quality", "image_quality", {"snr_of": "mean"}),
    )  # fmt: skip
    np.testing.assert_allclose(known.value("air.image"), 5.6, rtol=1e-12)
    assert known.figures("quality")["snr"] == pytest.approx(50.0, rel=1e-9)


TAU, WINDOW_K, SCENE_K = 0.8, 330.0, 290.0
BAND = (3.7, 4.8)
C1, C2 = 1.1910429723971884e8, 1.4387768775039337e4  # W µm⁴/m²/sr and µm K


def planck(kelvin):
    """Radiance of the band, W/m²/sr."""
    return quad(lambda x: C1 / x**5 / np.expm1(C2 / x / kelvin), *BAND, epsrel=1e-12)[0]


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    scene = {"kind": "uniform", "width": 16, "height": 12, "fov_x_deg": 1, "fov_y_deg": 1,
             "temperature_K": SCENE_K, "cut_on_um": BAND[0], "cut_off_um": BAND[1]}  # fmt: skip
    fpa = {"integration_time_s": 1e-3, "full_well_e": 1e9, "units": "electrons"}
    nodes = {
        "scene": ("test_scene", scene),
        "window": ("atmospheric_path", {"transmission": TAU, "air_K": WINDOW_K}),
        "init": ("init_trans", {"detector_x_um": 15, "detector_y_um": 15, "focal_length_mm": 50,
                                "f_number": 2}),
        "in_front": ("focal_plane", fpa),
        "inside": ("focal_plane", {**fpa, "optics_transmission": TAU, "optics_K": WINDOW_K}),
    }  # fmt: skip
    links = [("scene.image", "window.image"), ("scene.image", "init.image"),
             ("window.image", "in_front.image"), ("scene.image", "inside.image"),
             ("init.context", "in_front.context"), ("init.context", "inside.context")]  # fmt: skip
    return NodeBench(tmp_path_factory.mktemp("window"), nodes, links)


def test_in_front_and_inside_give_the_same_electrons(bench):
    """But for the scene's spectrum, which the sum in one band takes for that of one black body."""
    both = bench.readouts("in_front"), bench.readouts("inside")
    front, inside = (one["signal_e"] + (one["optics_e"] or 0.0) for one in both)
    assert front == pytest.approx(inside, rel=2e-3)
    assert both[1]["optics_e"] > 0.2 * both[1]["signal_e"]
