"""What is warned of pictures: by their samples, and by what their file says and lacks."""

import numpy as np
import pytest

from core.chain.wires import Header, Image
from core.evaluation.recipes import Step
from node_bench import NodeBench
from nodes.files.formats import write_picture
from nodes.input_output.read_image import ReadImage
from nodes.shared.module_ports import ImageOutput
from nodes.transform.init_trans import InitTrans
from picture_samples import envi
from planck_truth import band_radiance

INIT = {
    "detector_x_um": 20.0, "detector_y_um": 20.0, "focal_length_mm": 100.0, "f_number": 2.0,
    "scan_velocity_mrad_per_s": 900.0,
}  # fmt: skip


def checks(folder, **params):
    """Warnings of a node that reads a file, its samples looked at."""
    return cautions_of(NodeBench(folder, {"read": ("read_image", params)}))


def cautions_of(bench):
    assert bench.plan.errors() == []
    return bench.warnings()


def frame(mean, sigma):
    return mean + sigma * np.resize([-1.0, 1.0], (16, 16))


KELVIN = frame(290.0, 8.0)
LWIR = {"cut_on_um": 8.0, "cut_off_um": 14.0}
MWIR = {"cut_on_um": 3.0, "cut_off_um": 5.0}
VISIBLE = {"cut_on_um": 0.4, "cut_off_um": 0.7}
BANDS = {"cut_on_um": 0.6, "cut_off_um": 3.4}


class TestRadianceOfFiles:
    """Samples read as W/m²/sr that cannot be; limits from `test_scene_limits`."""

    @pytest.mark.parametrize("name", ["a.npy", "a.tif"])
    @pytest.mark.parametrize("dtype", ["float", "double"])
    @pytest.mark.parametrize("written", [{}, {"scale": 1.0}])
    def test_kelvin_without_a_band_looks_like_kelvin(self, tmp_path, name, dtype, written):
        if name == "a.npy":
            np.save(tmp_path / name, KELVIN.astype({"float": np.float32}.get(dtype, np.float64)))
        else:
            write_picture(tmp_path / name, KELVIN, dtype=dtype)
        (caution,) = checks(tmp_path, path=name, **written)
        assert (caution.node, caution.check) == ("read", "radiance")
        # (π 290 / 5.670374e-8)^¼ = 356.0
        assert caution.message == (
            "the unit may be wrong: the samples, 290 ± 8, look like temperatures in kelvin but "
            "are read as W/m²/sr; over all wavelengths, no scene below 356 K emits as much"
        )
        assert "such as K" in caution.remedy

    @pytest.mark.parametrize(
        ("samples", "params"),
        [
            (KELVIN, {"unit": "K"}),
            (KELVIN, {"scale": 2.0}),
            (KELVIN, {"unit": "W/m²/sr"}),  # somebody has said so, of a band nobody names
            (frame(55.0, 2.0), {}),
            (frame(55.0, 2.0), LWIR),  # 300 K
            (frame(2.0, 0.2), MWIR),
            (frame(100.0, 40.0), VISIBLE),  # in sunlight
            (frame(240.0, 90.0), {}),  # spread too far for temperatures
            (frame(0.0, 1.0), LWIR),  # noise
            (frame(20.0, 1.0), {}),
        ],
    )
    def test_what_may_be_radiance_is_silent(self, tmp_path, samples, params):
        np.save(tmp_path / "a.npy", samples)
        assert checks(tmp_path, path="a.npy", **params) == []


class TestRadianceOfElectronics:
    """A picture without a band, whose samples the electronics take for radiance of their own."""

    def cautions(self, folder, samples, *, unit="W/m²/sr", band=(8.0, 12.0), **read):
        np.save(folder / "a.npy", samples)
        source = {"path": "a.npy", "unit": unit, "fov_x_deg": 1.0, "fov_y_deg": 1.0, **read}
        own = {"cut_on_um": band[0], "cut_off_um": band[1], "bandwidth_Hz": 1e4, "region": "LWIR"}
        nodes = {
            "read": ("read_image", source),
            "init": ("init_trans", INIT),
            "electronics": ("electronics_noise", own),
        }
        return cautions_of(NodeBench(folder, nodes))

    def test_kelvin_is_more_than_the_band_gives(self, tmp_path):
        """The unit is typed, so that Read Image has nothing to say; the band is typed here."""
        (caution,) = self.cautions(tmp_path, KELVIN)
        assert (caution.node, caution.check) == ("electronics", "radiance")
        limit = band_radiance(8.0, 12.0, 353.95) + (6.957e8 / 1.495978707e11) ** 2 * band_radiance(
            8, 12, 5772.0
        )
        assert caution.message == (
            f"the samples' mean, 290 W/m²/sr, exceeds {limit:.3g} W/m²/sr, the most that a surface "
            "on Earth can emit and reflect from 8 to 12 µm; the samples look like temperatures in "
            "kelvin"
        )


def image(header):
    return Image(Step.of(np.zeros, shape=(4, 4)), 4, 4, 1.0, 1.0, header=header)


class TestFiles:
    def test_whole_numbers_taken_for_radiance(self):
        outputs = ImageOutput(image(Header(bare_integers=True)))
        caution = ReadImage.build({}).numbers_without_unit(outputs)
        assert "whole numbers" in caution.message
        assert "W/m²/sr" in caution.message
        for stated in ({"unit": "DN"}, {"scale": 0.01}):
            assert ReadImage.build(stated).numbers_without_unit(outputs) is None
        assert ReadImage.build({}).numbers_without_unit(ImageOutput(image(Header()))) is None

    def test_one_channel_of_a_colour_picture(self):
        outputs = ImageOutput(image(Header(channels=("R", "G", "B"))))
        caution = ReadImage.build({}).one_channel(outputs, frozenset())
        assert caution.message == "only channel R of this colour picture (R, G, B) is read"
        assert "0 to 2" in caution.remedy
        one = ImageOutput(image(Header(channels=("Y",))))
        assert ReadImage.build({}).one_channel(one, frozenset()) is None

    @pytest.mark.parametrize(
        ("params", "warned"),
        [({}, True), ({"band": 0}, False), ({"band": 2}, False), (BANDS, False)],
    )
    def test_one_band_of_a_cube(self, tmp_path, params, warned):
        """Unless it was chosen, or the bands are integrated."""
        fields = {"wavelength_units": "um", "wavelength": "{1, 2, 3}", "fwhm": "{1, 1, 1}"}
        envi(tmp_path / "a.img", np.zeros((4, 4, 3), np.float32), "bsq", **fields)
        found = {each.check: each for each in checks(tmp_path, path="a.img", unit="DN", **params)}
        assert ("one_band" in found) is warned
        if warned:
            assert found["one_band"].message == "only band 0 is read: the file contains 3 bands"
            assert found["one_band"].remedy == "for another band, set band (0 to 2)"

    def test_a_focal_length_other_than_the_files(self):
        init = InitTrans.build({"focal_length_mm": 100.0})
        caution = init.focal_length(image(Header(focal_length_mm=50.0)))
        assert "100 mm" in caution.message
        assert "50 mm" in caution.message
        assert init.focal_length(image(Header(focal_length_mm=100.0))) is None
        assert init.focal_length(image(Header())) is None
        assert InitTrans.build({}).focal_length(image(Header(focal_length_mm=50.0))) is None
