"""Camera: entered once, taken by what follows; figures by hand from a data sheet."""

import math

import numpy as np
import pytest

from core.chain.wires import Header, Image
from core.errors import ParameterError
from core.evaluation.recipes import Step
from core.modules.declaration import NodeContext
from core.physics.sampling.ground_geometry import orbit_view
from node_bench import NodeBench
from nodes.atmosphere.atmosphere_mtf import AtmosphereMTF
from nodes.optics.camera import Camera

# A cooled MWIR camera of data sheets: 640 × 512 of 15 µm, f/4, 100 mm.
MWIR = {
    "pixels_x": 640, "pixels_y": 512, "pitch_um": 15, "focal_length_mm": 100, "f_number": 4,
    "fill_x": 0.95, "fill_y": 0.9, "obscuration_ratio": 0.3, "range_m": 2000,
}  # fmt: skip


@pytest.fixture
def planned(tmp_path):
    def plan(camera, init=(), *, read=None):
        np.save(tmp_path / "in.npy", np.full((1024, 1280), 2.0))
        nodes = {
            "scene": ("read_image", {"path": "in.npy", **(read or {})}),
            "camera": ("camera", camera),
            "init": ("init_trans", dict(init)),
            "detector": ("detector_mtf", {}),
            "back": ("back_transform", {}),
            "pixels": ("sample_pixels", {}),
        }
        return NodeBench(tmp_path, nodes, precision="single")

    return plan


def texts(plan):
    return [str(caution) for caution in plan.warnings()]


def test_entered_once(planned):
    """Nothing is given on Init & Trans: the whole chain goes by the camera."""
    bench = planned(MWIR)
    plan = bench.plan
    assert plan.errors() == []
    assert texts(plan) == []
    context = plan.output("init.context")
    assert (context.detector_x_um, context.detector_y_um) == (15.0, 15.0)
    assert (context.focal_length_mm, context.f_number, context.aperture_mm) == (100, 4, 25)
    assert (context.fill_x, context.fill_y, context.range_m) == (0.95, 0.9, 2000)
    assert context.obscuration_ratio == 0.3
    # Two samples a pixel: 640 pixels of 0.15 mrad in 1280 samples.
    assert context.grid.interval_x_mrad == pytest.approx(0.075, rel=1e-15)
    assert plan.output("pixels.image").shape == (512, 640)
    assert plan.output("pixels.image").interval_y_mrad == pytest.approx(0.15, rel=1e-15)
    found = bench.readouts("camera")
    expected = {
        "pixel_x_mrad": 0.15, "fov_x_deg": math.degrees(2 * math.atan(0.048)),
        "fov_y_deg": math.degrees(2 * math.atan(0.0384)),
        "nyquist_x": 10 / 3, "f_number": 4.0, "aperture_mm": 25.0, "samples_per_pixel_y": 2.0,
        "gsd_x_m": 0.3,
    }  # fmt: skip
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=1e-14), name
    assert bench.readouts("init")["ifov_x_mrad"] == pytest.approx(0.1425, rel=1e-14)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"focal_length_mm": 100, "aperture_mm": 40}, (100, 2.5, 40)),
        ({"f_number": 2.5, "aperture_mm": 40}, (100, 2.5, 40)),
        ({"focal_length_mm": 100, "f_number": 2.5}, (100, 2.5, 40)),
        ({"focal_length_mm": 100, "f_number": 2.45, "aperture_mm": 40}, (100, 2.45, 40)),
    ],
)
def test_two_of_three_give_the_third(planned, given, expected):
    plan = planned({"pixels_x": 640, "pixels_y": 512, "pitch_um": 15, **given}).plan
    sheet = plan.output("camera.image").camera
    assert (sheet.focal_length_mm, sheet.f_number, sheet.aperture_mm) == pytest.approx(expected)


@pytest.mark.parametrize(
    ("init", "words"),
    [
        ({"detector_x_um": 12}, ("detector_x_um = 12 µm here", "15 µm on Camera")),
        ({"focal_length_mm": 50}, ("focal_length_mm = 50 mm", "100 mm on Camera")),
        ({"f_number": 2}, ("f_number = 2", "4 on Camera")),
        ({"range_m": 500}, ("range_m = 500 m", "2000 m on Camera")),
        ({"fill_y": 0.5}, ("fill_y = 0.5", "0.9 on Camera")),
        ({"fill_x": 1.0}, ("fill_x = 1 is treated as empty", "0.95 from Camera")),
    ],
)
def test_what_init_gives_otherwise_is_warned_of(planned, init, words):
    plan = planned(MWIR, init).plan
    (name, value) = next(iter(init.items()))
    assert getattr(plan.output("init.context"), name) == (0.95 if name == "fill_x" else value)
    (text,) = [t for t in texts(plan) if t.startswith("init:")]
    for word in words:
        assert word in text
    # What the optics here overrule is no aperture of theirs.
    aperture = plan.output("init.context").aperture_mm
    assert aperture == (None if name in ("focal_length_mm", "f_number") else 25)


def test_a_second_transform_takes_the_camera_and_not_the_first(planned):
    """An Init & Trans alone leaves the next one as it was: old networks keep their results."""
    bench = planned({}, {"detector_x_um": 9, "detector_y_um": 9, "focal_length_mm": 60,
                         "fov_x_deg": 5, "fov_y_deg": 4, "fill_x": 0.5})  # fmt: skip
    image = bench.port("back.image")
    assert image.camera.pitch_x_um is None
    assert image.camera.fill_x is None
    assert image.pixel_mrad == (0.15, 0.15)


def test_another_focal_length_in_the_file():
    image = Image(Step.of(np.zeros), 8, 8, header=Header(focal_length_mm=50.0))
    caution = Camera.build({"focal_length_mm": 100}).focal_length(image)
    assert "focal_length_mm = 100 mm here but 50 mm in the picture's file" in caution.text
    assert Camera.build({"focal_length_mm": 50.2}).focal_length(image) is None


def test_a_short_exposure_takes_the_cameras_aperture(planned):
    """Fried's form of D = 25 mm, as where it is typed; without either it is refused."""
    values = []
    for camera, typed in ((MWIR, {}), (MWIR, {"aperture_mm": 25}), ({}, {})):
        plan = planned(camera, {} if camera else {"fov_x_deg": 5, "fov_y_deg": 4}).plan
        context = plan.output("init.context")
        air = {"turbulence": "short_exposure", "fried_r0_m": 0.05, "wavelength_um": 4.2, **typed}
        module = AtmosphereMTF.build(air)
        magnitude = plan.output("init.magnitude")
        if not camera:
            with pytest.raises(ParameterError, match="aperture_mm"):
                module.run(context, magnitude, NodeContext("air"))
            continue
        values.append(module.run(context, magnitude, NodeContext("air")).mtf.key)
    assert values[0] == values[1]


def test_an_orbit_is_entered_once(planned):
    """694 km, 30° beside the track: range, elevation and speed of test_orbit's traced rays."""
    satellite = {"pixels_x": 640, "pixels_y": 512, "pitch_um": 13, "focal_length_mm": 12900,
                 "altitude_km": 694, "look_angle_deg": 30}  # fmt: skip
    bench = planned(satellite)
    assert texts(bench.plan) == []
    view = orbit_view(altitude_km=694.0, look_angle_deg=30.0)
    context = bench.port("init.context")
    seen = (context.range_m, context.velocity_m_per_s, context.elevation_deg)
    assert seen == (view.range_m, view.velocity_m_per_s, view.elevation_deg)
    found = bench.readouts("camera")
    gsd = 0.013 / 12900 * view.range_m
    assert (found["gsd_x_m"], found["gsd_ground_y_m"]) == pytest.approx((gsd, gsd))
    sine = math.sin(math.radians(view.elevation_deg))
    assert found["gsd_ground_x_m"] == pytest.approx(gsd / sine, rel=1e-12)
    assert found["line_rate_Hz"] == pytest.approx(view.velocity_m_per_s / gsd, rel=1e-12)


@pytest.mark.parametrize(("scale", "words"), [(1.0, "1 sample per"), (1.5, "1.5 samples per")])
def test_few_samples_are_counted(planned, scale, words):
    fov = {f"fov_{a}_deg": math.degrees(0.15e-3 / scale * n) for a, n in (("x", 1280), ("y", 1024))}
    plan = planned(MWIR, read=fov).plan
    assert any(f"the picture has {words} pixel, and" in text for text in texts(plan))


@pytest.mark.parametrize(
    ("camera", "init", "words"),
    [
        (
            {"altitude_km": 600, "range_m": 6.1e5},
            {},
            "range_m = 6.1e+05 m here but 6e+05 m from alti",
        ),
        # The Earth turns by 465 m/s at the equator, the point below a GPS satellite by 929.
        ({"altitude_km": 20200}, {}, "by up to 50 %: at altitude_km = 20200 the Earth's rotation"),
        ({"look_angle_deg": 20}, {}, "look_angle_deg = 20° is not used"),
        (
            {"altitude_km": 600},
            {"velocity_m_per_s": 7500},
            "6908 m/s on Camera. Set velocity_m_per_s to 0",
        ),
    ],
)
def test_two_truths_of_an_orbit_are_warned_of(planned, camera, init, words):
    plan = planned({**MWIR, "range_m": None, **camera}, init).plan
    (text,) = texts(plan)
    assert words in text
