"""What illustrations are told, against formulas and figures that come from elsewhere."""

import math

import numpy as np
import pytest

from app.editor.panels.illustrations.exit_pupil_illustration import PupilQuery
from app.editor.panels.illustrations.sampling_illustration import SamplingQuery, footprint_of
from app.editor.panels.illustrations.shrinking import shrunk
from app.editor.panels.illustrations.thumbnail_illustration import ThumbnailQuery
from app.editor.panels.illustrations.transfer_query import TransferQuery
from app.editor.panels.illustrations.wavefront import open_share, wavefront_of
from core.modules.declaration import NodeContext
from core.network.network import Network, Node
from core.physics.optics.pupil_shapes import PupilShape
from illustration_hands import INFRAMETRICS, LIBRARY, answer, sensor

NYQUIST = 0.488924  # of 30° and 512 samples, fig. 4.3


def test_jitter_is_a_gaussian_up_to_nyquist():
    sigma = 0.6
    lines = answer(TransferQuery("node"), sensor("jitter_mtf", {"sigma_mrad": sigma}))
    for line in (lines.x, lines.y):
        assert line.frequency[0] == 0
        assert line.nyquist == pytest.approx(NYQUIST, abs=5e-7)
        assert line.frequency[-1] == pytest.approx(line.nyquist)
        expected = np.exp(-2 * np.pi**2 * sigma**2 * line.frequency**2)
        np.testing.assert_allclose(line.values, expected, rtol=1e-12)
        assert line.at_nyquist == pytest.approx(
            math.exp(-2 * math.pi**2 * (sigma * NYQUIST) ** 2), 1e-5
        )
        assert line.half == pytest.approx(math.sqrt(math.log(2) / 2) / (math.pi * sigma), rel=2e-5)
        assert line.cutoff is None
    assert lines.alike


def test_the_negative_lobe_of_a_detector_stays_negative():
    params = {
        "detector_x_um": 600.0,
        "detector_y_um": 60.0,
        "focal_length_mm": 130.0,
        "fill_x": 0.95,
    }
    lines = answer(TransferQuery("node"), sensor("detector_mtf", params))
    width = 600 / 130 * 0.95
    at = 1.5 / width
    assert np.interp(at, lines.x.frequency, lines.x.values) == pytest.approx(
        -2 / (3 * math.pi), abs=1e-4
    )
    assert lines.y.values.min() > 0.9
    assert not lines.alike
    assert lines.y.half is None
    assert lines.x.half == pytest.approx(0.60335 / width, rel=1e-3)  # sinc is one half there


def test_an_aperture_is_shown_up_to_its_cutoff():
    lines = answer(TransferQuery("node"), sensor("exit_pupil_mtf", pupil={"radius": 75.0}))
    for line in (lines.x, lines.y):
        assert line.cutoff == pytest.approx(7.5, rel=1e-9)  # 7.5 cm over 10 µm
        assert line.frequency[-1] == pytest.approx(7.5, rel=1e-9)
        assert line.at_nyquist == pytest.approx(0.9171, abs=5e-5)
        ratio = line.frequency / 7.5
        disc = 2 / np.pi * (np.arccos(ratio) - ratio * np.sqrt(1 - ratio**2))
        np.testing.assert_allclose(line.values, disc, atol=1e-9)


def test_an_aperture_that_ends_below_nyquist_is_shown_up_to_nyquist():
    pupil = {"radius": 3.0, "size_x": 512, "size_y": 512}
    lines = answer(TransferQuery("node"), sensor("exit_pupil_mtf", pupil=pupil))
    assert lines.x.cutoff == pytest.approx(0.3)
    assert lines.x.frequency[-1] == pytest.approx(NYQUIST, rel=1e-5)
    np.testing.assert_allclose(lines.x.values[lines.x.frequency > 0.3], 0, atol=1e-12)


def test_the_raw_autocorrelation_has_the_pupil_s_own_frequencies():
    params = {"interpolation": "none"}
    lines = answer(TransferQuery("node"), sensor("exit_pupil_mtf", params, pupil={"radius": 75.0}))
    step = 25.6 * 10 / 512 / 10  # cm, samples, µm
    for line in (lines.x, lines.y):
        np.testing.assert_allclose(np.diff(line.frequency), step, rtol=1e-9)
        ratio = np.minimum(line.frequency / 7.5, 1)
        disc = 2 / np.pi * (np.arccos(ratio) - ratio * np.sqrt(1 - ratio**2))
        np.testing.assert_allclose(line.values, disc, atol=5e-3)
        assert line.frequency[-1] >= 7.5
        assert line.at_nyquist == pytest.approx(0.9171, abs=5e-3)


def test_the_published_phase_of_charge_transfer():
    params = {"model": "published"}
    lines = answer(TransferQuery("node", "ptf"), sensor("charge_eff_phase", params))
    w = np.pi * lines.x.frequency / lines.x.nyquist
    np.testing.assert_allclose(lines.x.values, -0.0064 * (w - np.sin(w)), atol=1e-9)  # eq. 4.58
    assert lines.x.at_nyquist == pytest.approx(-0.0201, abs=5e-5)  # fig. 5.44
    assert not lines.y.values.any()
    assert lines.x.half is None


def test_turbidity_is_shown_down_to_where_light_is_scattered_aside():
    params = {"turbulence": "none", "turbidity": "moderate"}
    lines = answer(TransferQuery("node"), sensor("atmosphere_mtf", params))
    assert lines.turn == 0.001
    assert lines.x.frequency[1] < 1e-4
    beyond = lines.x.frequency > 0.001
    np.testing.assert_allclose(lines.x.values[beyond], 0.975, rtol=1e-9)
    depth = -math.log(0.975)
    below = lines.x.frequency[~beyond]
    expected = np.exp(-depth * (below / 0.001) ** 2)
    np.testing.assert_allclose(lines.x.values[~beyond], expected, rtol=1e-9)


def test_the_geometry_of_the_inframetrics():
    context = answer(SamplingQuery("init"), sensor("jitter_mtf", init=INFRAMETRICS))
    footprint = footprint_of(context)
    assert footprint.pitch == pytest.approx((600 / 130, 600 / 130))
    assert footprint.sensitive == pytest.approx((4.3846, 4.3846), abs=5e-5)
    assert context.grid.nyquist_x == pytest.approx(NYQUIST, abs=5e-7)


def test_there_is_no_footprint_without_a_focal_length():
    init = {"detector_x_um": 30.0, "detector_y_um": 30.0}
    assert footprint_of(answer(SamplingQuery("init"), sensor("jitter_mtf", init=init))) is None


def aberrated(**params):
    module = LIBRARY["exit_pupil"].build(params)
    return wavefront_of(module.run(here=NodeContext("node")).pupil)


def test_the_rms_of_a_wavefront_is_that_of_its_coefficients():
    coefficients = [0.0, 0.05, 0.0, 0.1, -0.02, 0.0, 0.03, 0.0, 0.0, 0.0, 0.04]
    expected = math.sqrt(sum(c**2 for c in coefficients))
    assert aberrated(zernike_waves=coefficients).rms == pytest.approx(expected, rel=0.02)


def test_defocus_is_nothing_in_the_middle_and_all_at_the_rim():
    found = aberrated(defocus_waves=0.5)
    assert found.rms == pytest.approx(0.5 / math.sqrt(12), rel=0.01)
    assert found.least == pytest.approx(0.0, abs=2e-3)
    assert found.most == pytest.approx(0.5, rel=0.03)
    assert aberrated() is None


def test_the_wavefront_of_an_annulus_is_told_where_it_is_open():
    found = aberrated(defocus_waves=1.0, shape="cassegrain", radius=100.0, obscuration_radius=50.0)
    assert found.least == pytest.approx(0.25, abs=0.03)
    assert found.rms == pytest.approx(0.75 / math.sqrt(12), rel=0.03)


def slit_share(outer, inner, width):
    """Share of a disc left by an annulus with a bar, by integration across the bar."""
    x = np.linspace(-width / 2, width / 2, 20001)
    chord = 2 * (np.sqrt(outer**2 - x**2) - np.sqrt(np.maximum(inner**2 - x**2, 0)))
    covered = np.trapezoid(chord, x)
    return (math.pi * (outer**2 - inner**2) - covered) / (math.pi * outer**2)


def spider_of_two(outer, width):
    """Two opposite vanes are a bar; a hole no wider than the bar takes nothing more."""
    return slit_share(outer, 0, width)


@pytest.mark.parametrize(
    ("shape", "share"),
    [
        (PupilShape("clear", 75.0), 1.0),
        (PupilShape("half_moon", 75.0), 0.5),
        (PupilShape("cassegrain", 75.0, 25.0), 8 / 9),
        (PupilShape("hinged", 75.0, slit_width=30.0), slit_share(75, 0, 30)),
        (PupilShape("cassegrain_slit", 75.0, 25.0, 30.0), slit_share(75, 25, 30)),
        (PupilShape("spider", 75.0, 5.0, vanes=2, vane_width=10.0), spider_of_two(75, 10)),
    ],
    ids=lambda value: getattr(value, "shape", ""),
)
def test_how_much_of_the_disc_is_open(shape, share):
    assert open_share(shape) == pytest.approx(share, abs=1e-4)


def test_a_pupil_of_a_file_is_made_small(tmp_path):
    samples = np.zeros((600, 1200))
    samples[:, 600:] = 2.0
    np.save(tmp_path / "pupil.npy", samples)
    params = {"shape": "file", "path": "pupil.npy"}
    network = Network(nodes={"node": Node("node", "exit_pupil", params)})
    found = answer(PupilQuery("node"), network, tmp_path)
    assert (found.rows, found.columns) == (600, 1200)
    assert found.open_share == pytest.approx(0.5)
    high, wide = found.levels.shape
    assert wide == 2 * high <= 256
    assert (found.levels[:, : wide // 2] == 0).all()
    assert (found.levels[:, wide // 2 :] == 255).all()


def test_a_geometric_pupil_has_no_samples_to_be_asked_for():
    assert answer(PupilQuery("pupil"), sensor("jitter_mtf")) is None


def test_a_thumbnail_has_the_picture_s_extremes_and_its_black_and_white():
    scene = {"kind": "two_panel", "width": 900, "height": 300}
    found = answer(ThumbnailQuery("scene"), sensor("jitter_mtf", scene=scene))
    high, wide = found.grey.shape
    assert wide == 3 * high <= 320
    assert set(np.unique(found.grey[:, [0, -1]])) == {0, 255}
    assert found.low < found.high


@pytest.mark.parametrize("shape", [(1, 1), (7, 5), (640, 640), (641, 3), (1, 5000), (2047, 999)])
def test_a_small_picture_keeps_its_mean(shape):
    rng = np.random.default_rng(5)
    slope = np.add.outer(np.linspace(0, 1, shape[0]), np.linspace(0, 2, shape[1]))
    small = shrunk(slope + 1e-6 * rng.standard_normal(shape), 64)
    assert max(small.shape) <= 64
    assert small.flags.c_contiguous
    assert small.mean() == pytest.approx(slope.mean(), abs=0.05)
    longest = max(range(2), key=lambda axis: shape[axis])
    assert small.shape[longest] >= min(shape[longest], 32)
