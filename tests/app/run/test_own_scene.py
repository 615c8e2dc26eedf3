"""A picture of one's own in place of a network's scene, against arrays worked out by hand."""

import json
import math

import numpy as np
import pytest
from scipy.constants import c, h, k
from scipy.integrate import quad

from app.run.shipped import shipped_networks
from nodes.files.formats import read_info, read_pixels
from picture_samples import by_openimageio, envi

TWO_SCENES = {"magnitude_of_one_phase_of_another": "building"}
Y, X = np.mgrid[0:24, 0:32]
GREY = (Y * 9 + X).astype(np.uint8)  # 0 to 238
COLOURS = np.stack([GREY, GREY[::-1], 255 - GREY], -1)


@pytest.fixture
def picture(tmp_path):
    """Write a picture into the folder the command runs in."""

    def save(samples, name="own.tif"):
        by_openimageio(tmp_path / name, samples)
        return name

    return save


@pytest.fixture
def scene_of(works, tmp_path):
    """What a run has on the wire of the scene, with what it prints."""

    def run(network, *words, port="scene.image"):
        done = works("run", network, *words, "--save", f"{port}=wire.npy")
        return np.load(tmp_path / "wire.npy"), done.stdout

    return run


def readouts(tmp_path, name="net"):
    return json.loads((tmp_path / f"{name}-output/readouts.json").read_text())


@pytest.mark.thorough(but=4, always=("magnitude_of_one", "dirsig_cube"))
@pytest.mark.parametrize("name", shipped_networks())
def test_every_shipped_network_takes_a_picture(imagechain, picture, tmp_path, name):
    file = picture(1000 + np.uint16(20) * GREY.repeat(3, 0).repeat(3, 1))
    scene = TWO_SCENES.get(name)
    done = imagechain("run", name, "--scene", f"{scene}={file}" if scene else file)
    if scene:  # its other picture has another size
        assert "both must have the same size" in done.stderr
        other = ("--scene", f"star={file}")
        done = imagechain("run", name, "--scene", f"{scene}={file}", *other)
    assert (done.returncode, done.stderr) == (0, "")
    assert "replaces" in done.stdout
    final = read_info(tmp_path / f"{name}-output/final.png")
    assert min(final.rows, final.columns) >= 24
    levels = read_pixels(tmp_path / f"{name}-output/final.png") / 255.0
    assert np.std(levels) > 0.02  # a picture is in it


def test_eight_bits_become_the_range_of_the_scene_before(scene_of, write, small, picture):
    before, _ = scene_of(write(small))
    low, high = float(before.min()), float(before.max())
    now, said = scene_of("net.json", "--scene", picture(GREY))
    np.testing.assert_allclose(now, low + (high - low) * GREY / 255.0, rtol=1e-6)
    assert f"8-bit samples 0…255 scaled to {low:.4g}…{high:.4g} W/m²/sr" in said


def test_other_samples_fill_that_range(scene_of, write, small, picture):
    before, _ = scene_of(write(small))
    now, said = scene_of("net.json", "--scene", picture((300 + 2.0 * GREY).astype(np.uint16)))
    assert (now.min(), now.max()) == pytest.approx((before.min(), before.max()), rel=1e-6)
    share = GREY / GREY.max()
    expected = before.min() + (before.max() - before.min()) * share
    np.testing.assert_allclose(now, expected, rtol=1e-5)
    assert "samples 300…" in said


def test_colours_are_their_luminance(scene_of, write, small, picture):
    write(small)
    file = picture(COLOURS, "own.png")
    now, said = scene_of("net.json", "--scene", file)
    luminance = COLOURS @ np.array([0.2126, 0.7152, 0.0722])
    np.testing.assert_allclose(
        (now - now.min()) / np.ptp(now),
        (luminance - luminance.min()) / np.ptp(luminance),
        atol=1e-5,
    )
    assert "from the luminance of the colours" in said


def planck(kelvin, low_um, high_um):
    """Radiance of a black body in a band, W/m²/sr, by quadrature."""

    def at(wavelength):
        return 2 * h * c**2 / wavelength**5 / math.expm1(h * c / (wavelength * k * kelvin))

    return quad(at, low_um * 1e-6, high_um * 1e-6, epsrel=1e-10)[0]


def test_temperatures_become_radiance(scene_of, write, small, picture):
    write(small)
    kelvin = (290.0 + GREY / 16.0).astype(np.float32)
    words = ("--scene", picture((kelvin - 273.15).astype(np.float32)), "--scene-unit", "C")
    band = ("--scene-band-um", 3.7, 4.8, "--precision", "double")
    now, said = scene_of("net.json", *words, *band, port="to_radiance.image")
    assert now[5, 7] == pytest.approx(planck(float(kelvin[5, 7]), 3.7, 4.8), rel=1e-5)
    assert "To Radiance (to_radiance) converts the scene to radiance" in said
    assert "band 3.7 to 4.8 µm, outside the original scene's band, 8 to 12 µm" in said


def test_reflectances_are_lit(scene_of, write, small, picture):
    now, _ = scene_of(
        write(small), "--scene", picture(GREY), "--scene-unit", "reflectance",
        "--set", "reflected_light.solar_irradiance=100", "--scene-band-um", 0.5, 0.8,
        port="reflected_light.image",
    )  # fmt: skip
    white = 100 * 0.3 * math.sin(math.radians(45)) / math.pi
    np.testing.assert_allclose(now, white * GREY / 255.0, rtol=1e-6)


def test_a_unit_of_radiance_is_taken_as_it_is(scene_of, write, small, picture):
    write(small)
    samples = (1.0 + GREY / 100.0).astype(np.float32)
    file = picture(samples)
    now, _ = scene_of("net.json", "--scene", file, "--scene-unit", "mW/cm^2/sr")
    np.testing.assert_allclose(now, 10.0 * samples, rtol=1e-6)
    density = ("--scene-unit", "W/m²/sr/µm", "--scene-band-um", 8, 10)
    now, said = scene_of("net.json", "--scene", file, *density)
    np.testing.assert_allclose(now, 2.0 * samples, rtol=1e-6)
    assert "multiplied by the width of the band" in said


@pytest.mark.parametrize(
    ("words", "fov_deg"),
    [
        ((), (2.5 / 24 * 32 if 2.5 / 24 < 3 / 32 else 3.0, 3.0 / 32 * 24)),
        (("--scene-fov-deg", 5, 4), (5.0, 4.0)),
        (
            ("--scene-sample-m", 0.5, "--scene-range-m", 400),
            (math.degrees(0.00125 * 32), math.degrees(0.00125 * 24)),
        ),
    ],
)
def test_the_field_of_view(works, write, small, picture, tmp_path, words, fov_deg):
    done = works("run", write(small), "--scene", picture(GREY), *words)
    found = readouts(tmp_path)["init"]
    interval = 1000 * math.radians(fov_deg[0]) / 32, 1000 * math.radians(fov_deg[1]) / 24
    assert found["interval_x_mrad"] == pytest.approx(interval[0], rel=1e-12)
    assert found["interval_y_mrad"] == pytest.approx(interval[1], rel=1e-12)
    assert f"field of view {fov_deg[0]:.4g} × {fov_deg[1]:.4g}°" in done.stdout


def test_the_field_of_view_of_a_camera_is_never_exceeded(imagechain, picture, tmp_path):
    square = np.ascontiguousarray(GREY[:, :24])
    imagechain("run", "mwir_camera", "--scene", picture(square), "--scene-range-m", 250)
    found = readouts(tmp_path, "mwir_camera")
    assert found["init"]["interval_x_mrad"] == pytest.approx(512 * 0.15 / 24, rel=1e-12)
    assert found["camera"]["gsd_x_m"] == pytest.approx(0.15e-3 * 250, rel=1e-12)
    info = read_info(tmp_path / "mwir_camera-output/final.png")
    assert (info.rows, info.columns) == (512, 512)


def cube(tmp_path, unit="W/m^2/sr/um"):
    """Four bands from 8 to 12 µm, of 1, 2, 3, 4 W/m²/sr/µm times a picture."""
    bands = np.arange(1.0, 5.0)[:, None, None] * (1.0 + GREY / 255.0)
    fields = {"wavelength_units": "um", "wavelength": "{8.5, 9.5, 10.5, 11.5}"}
    fields |= {"fwhm": "{1, 1, 1, 1}"} | ({"data_units": unit} if unit else {})
    envi(tmp_path / "cube.img", bands.transpose(1, 2, 0).astype("f4"), "bsq", **fields)
    return "cube.img"


@pytest.mark.parametrize(("bands", "said"), [(0, "summed"), (8, "kept separate")])
def test_a_cube(scene_of, write, small, tmp_path, bands, said):
    small["nodes"]["scene"]["params"] |= {"bands": bands, "kind": "dormitory"}
    small["nodes"]["scene"]["params"] |= {"cut_on_um": 9.0, "cut_off_um": 13.0}
    now, text = scene_of(write(small), "--scene", cube(tmp_path))
    np.testing.assert_allclose(now, (2 + 3 + 4) * (1 + GREY / 255.0), rtol=1e-5)
    assert f"4 bands, {said}, 9 to 12 µm, 75 % of 9 to 13 µm" in text


def test_several_scenes_are_asked_about(fails, picture):
    file = picture(GREY)
    error = fails("run", "magnitude_of_one_phase_of_another", "--scene", file)
    assert "2 scenes, star, building: name one scene, as in --scene star=FILE" in error


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--scene", "nothing.tif"), "nothing.tif: no such file"),
        (
            ("--scene", "own.tif", "--scene-fov-deg", 4, 200),
            "--scene-fov-deg 200 is not allowed: must be above 0°",
        ),
        (("--scene", "own.tif", "--scene-unit", "W/m2"), "'W/m2' is not understood"),
        (("--scene", "own.tif", "--scene-sample-m", 1), "--scene-sample-m needs --scene-range-m"),
        (
            ("--scene", "cube.img"),
            "the file does not give the unit of its bands. Give --scene-unit",
        ),
        (
            ("--scene", "cube.img", "--scene-unit", "W/m²/sr/µm", "--scene-band-um", 3, 5),
            "the bands of the file, 8 to 12 µm, do not overlap 3 to 5 µm",
        ),
    ],
)
def test_bad_input(fails, write, small, picture, tmp_path, words, said):
    write(small)
    picture(GREY)
    cube(tmp_path, unit="")
    assert said in fails("run", "net.json", *words)


def test_what_followed_the_scene_keeps_its_value(works, write, small, picture, tmp_path):
    small["nodes"]["blur"]["params"]["sigma_x_mrad"] = {"expression": "scene.width / 100"}
    done = works("run", write(small), "--scene", picture(GREY))
    assert (
        "blur.sigma_x_mrad is now fixed at 0.48: it was linked to the original scene" in done.stdout
    )


def test_solve_and_study_take_it(imagechain, works, write, small, picture, tmp_path):
    words = (write(small), "--scene", picture(GREY), "--scene-fov-deg", 4, 3)
    interval = 1000 * math.radians(4.0) / 32
    done = imagechain("solve", *words, "--for", "init.focal_length_mm", "--until",
                      f"init.nyquist_x={0.5 / interval}")  # fmt: skip
    assert "replaces Test Scene" in done.stdout
    vary = ("--vary", "blur.sigma_x_mrad=0.1,0.2", "--figure", "init.interval_x_mrad")
    works("study", *words, *vary, "--output", "s.csv", "--jobs", 1)
    rows = (tmp_path / "s.csv").read_text().splitlines()[1:]
    assert [float(row.split(",")[2]) for row in rows] == pytest.approx([interval] * 2, rel=1e-12)
