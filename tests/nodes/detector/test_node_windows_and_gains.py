"""Windows of the detector, pixels read at two gains, and microlenses: against plain arithmetic."""

import numpy as np
import pytest

from core.chain.noise_power import NoisePower
from core.errors import ParameterError
from linked_network import linked_network
from node_bench import NodeBench
from region_checks import assert_parts
from short_chain import short_chain

ROWS, COLUMNS = 46, 60
FOCAL = {"detector_x_um": 10, "detector_y_um": 10, "focal_length_mm": 100}


def made(folder, module, params, picture=None, interval_mrad=0.1):
    picture = np.random.default_rng(3).random((ROWS, COLUMNS)) + 1.0 if picture is None else picture
    bench, last = short_chain(
        folder, picture, [(module, params)], interval_mrad=interval_mrad, init=FOCAL
    )
    return bench, last


@pytest.mark.parametrize(("params", "window"), [
    ({"columns": 20, "rows": 16}, np.s_[15:31, 20:40]),
    ({"columns": 21, "left": 0}, np.s_[:, 0:21]),
    ({"rows": 9, "top": 37}, np.s_[37:46, :]),
])  # fmt: skip
def test_a_window_is_its_part_of_the_picture(tmp_path, params, window):
    bench, last = made(tmp_path, "read_window", params)
    found = bench.value(last)
    np.testing.assert_array_equal(found, bench.value("back.image")[window])
    assert bench.port(last).shape == found.shape
    assert bench.port(last).interval_x_mrad == pytest.approx(0.1)


def test_a_window_is_read_faster(tmp_path):
    params = {"rows": 16, "row_time_us": 12.5, "overhead_us": 50}
    bench, _ = made(tmp_path, "read_window", params)
    assert bench.readouts("read_window")["frame_rate_Hz"] == pytest.approx(1 / 250e-6)


@pytest.mark.parametrize(("params", "message"), [
    ({"columns": 61}, "columns = 61.*at most 60"), ({"rows": 47}, "rows = 47.*at most 46"),
    ({"columns": 30, "left": 31}, "left = 31.*at most 30"),
    ({"rows": 40, "top": 7}, "top = 7.*at most 6"),
])  # fmt: skip
def test_a_window_beyond_the_detector_is_refused(tmp_path, params, message):
    bench, _ = made(tmp_path, "read_window", params)
    with pytest.raises(ParameterError, match=message):
        raise bench.error("read_window")


def test_noise_in_a_window_is_that_of_its_pixels(tmp_path):
    """White noise by its pixels' variances; coloured noise as Σ power × its waves' squares."""
    bench, last = made(tmp_path, "read_window", {"columns": 20, "rows": 16, "left": 3, "top": 5})
    change = bench.port(last).recipe.lineage.linear
    random = np.random.default_rng(5)
    variances, power = random.random((2, ROWS, COLUMNS))
    white = change.noise(bench.work, NoisePower.white(ROWS, COLUMNS, variances))
    assert white.variance == pytest.approx(variances[5:21, 3:23].mean(), rel=1e-12)
    cut = change.noise(bench.work, NoisePower(ROWS, COLUMNS, power))
    down, across = (
        np.array([np.cos(np.pi * k * (2 * np.arange(n) + 1) / (2 * n)) * np.sqrt((2 - (k == 0)) / n)
                  for k in range(n)])
        for n in (ROWS, COLUMNS)
    )  # fmt: skip
    expected = np.einsum("kl,ky,lx->yx", power, down[:, 5:21] ** 2, across[:, 3:23] ** 2).mean()
    assert cut.variance == pytest.approx(expected, rel=1e-9)
    assert (cut.rows, cut.columns) == (16, 20)


RAMP = np.linspace(0.0, 1000.0, ROWS * COLUMNS).reshape(ROWS, COLUMNS)


def dual(folder, params, **pictures):
    """A ramp from dark to bright, read at two gains; the low one is a fourth, 1 too high."""
    nodes, links = {"dual": ("dual_gain", params)}, []
    for name, picture in {"high": np.minimum(RAMP, 400.0), "low": RAMP / 4 + 1, **pictures}.items():
        np.save(folder / f"{name}.npy", picture)
        nodes[name] = ("read_image", {"path": f"{name}.npy", "fov_x_deg": 1, "fov_y_deg": 1})
        links.append((f"{name}.image", f"dual.{name}"))
    return NodeBench(folder, nodes, links)


@pytest.mark.parametrize("blend", [0, 40])
def test_dark_pixels_are_of_the_high_gain_and_bright_ones_of_the_low(tmp_path, blend):
    params = {"switch_level": 300, "blend_percent": blend, "low_factor": 4}
    bench = dual(tmp_path, params)
    found, low, begin = bench.value("dual.image"), RAMP + 4.0, 300 * (1 - blend / 100)
    np.testing.assert_array_equal(found[begin >= RAMP], RAMP[begin >= RAMP])
    np.testing.assert_allclose(found[RAMP > 300], low[RAMP > 300], rtol=1e-15)
    between = (begin < RAMP) & (RAMP <= 300)
    share = (RAMP[between] - begin) / max(300 - begin, 1e-300)
    np.testing.assert_allclose(found[between], RAMP[between] + 4.0 * share, rtol=1e-12)
    weight = np.where(RAMP > 300, 1.0, 0.0)
    weight[between] = share
    assert bench.readouts("dual")["low_percent"] == pytest.approx(100 * weight.mean())


@pytest.mark.parametrize(("level", "scale", "warned"), [
    (350, 1, ["noise of high"]), (600, 1, ["never used"]), (380, 0.4, []), (120, 0.2, []),
])  # fmt: skip
def test_a_switch_at_the_wrong_place_is_warned_of(tmp_path, level, scale, warned):
    """The high gain ends at 400: 600 is never reached; the mean is 500 times the scale."""
    bench = dual(tmp_path, {"switch_level": level, "low_factor": 4},
                 high=np.minimum(RAMP * scale, 400.0), low=RAMP * scale / 4)  # fmt: skip
    found = [c.message for c in bench.engine.warnings(bench.plan, bench.work) if c.node == "dual"]
    assert len(found) == len(warned)
    assert all(part in message for part, message in zip(warned, found, strict=True))


def test_read_outs_of_other_sizes_are_refused(tmp_path):
    bench = dual(tmp_path, {"switch_level": 1}, low=RAMP[:-1])
    assert "same size: high has 60 × 46 and low has 60 × 45" in str(bench.error("dual"))


def joined(folder, low, units, factor, unlinked=()):
    """A camera read at two gains."""
    gain = {"integration_time_s": 1e-5, "units": units, "bits": 0, "optics_transmission": 1}
    nodes = {
        "scene": ("test_scene", {"width": 32, "height": 32}),
        "camera": ("camera", {"pitch_um": 15, "focal_length_mm": 50, "f_number": 4}),
        "init": ("init_trans", {}),
        "high": ("focal_plane", {**gain, "full_well_e": 2000, "read_noise_e": 1.5}),
        "low": ("focal_plane", {**gain, "full_well_e": 30000, "read_noise_e": 20, **low}),
        "dual": ("dual_gain", {"switch_level": 1800, "low_factor": factor}),
    }
    links = [("scene.image", "camera.image"), ("camera.image", "init.image")]
    for name in ("high", "low"):
        links += [("camera.image", f"{name}.image"), ("init.context", f"{name}.context")]
        links += [(f"{name}.image", f"dual.{name}"), (f"{name}.table", f"dual.{name}_table")]
    links = [link for link in links if link[1].partition(".")[2] not in unlinked]
    return NodeBench(folder, nodes, links)


@pytest.mark.parametrize(("low", "units", "factor", "warned"), [
    ({}, "electrons", 1, False), ({}, "electrons", 2, True),
    ({"integration_time_s": 2.5e-6}, "electrons", 4, False),
    ({"integration_time_s": 2.5e-6}, "radiance", 1, False),
])  # fmt: skip
def test_the_joined_range_is_from_one_noise_to_the_other_saturation(
    tmp_path, low, units, factor, warned
):
    """Wells of 2,000 and 30,000 e-, 1.5 e- read noise: 20 lg(30,000/1.5), without dark current.

    A fourth of the exposure sees four times as bright a scene, and its factor is 4; a radiance is
    one and the same by either, and needs no factor.
    """
    bench = joined(tmp_path, low, units, factor)
    found = bench.readouts("dual")["dynamic_range_dB"]
    assert found == pytest.approx(20 * np.log10(30000 * (4 if low else 1) / 1.5), rel=1e-9)
    told = bench.engine.warnings(bench.plan, bench.work)
    assert [c.check for c in told if c.node == "dual" and c.check == "factor"] == [
        "factor"
    ] * warned


@pytest.mark.parametrize("unlinked", [("high_table",), ("low_table",), ("high_table", "low_table")])
def test_without_either_table_there_is_no_joined_range_and_no_word_of_the_factor(
    tmp_path, unlinked
):
    bench = joined(tmp_path, {}, "electrons", 2, unlinked)
    assert bench.readouts("dual").get("dynamic_range_dB") is None
    told = bench.engine.warnings(bench.plan, bench.work)
    assert not [caution for caution in told if caution.check == "factor"]


@pytest.mark.parametrize("measured", [False, True])
def test_the_picture_darkens_where_rays_miss_the_microlenses(tmp_path, measured):
    """Sample by sample; the angle at a height is that of the tangent in proportion."""
    params = {"chief_ray_deg": 28, "matched_deg": -2, "half_response_deg": 25}
    if measured:
        (tmp_path / "cra.csv").write_text("deg,response\n0,1\n15,0.9\n30,0.4\n")
        params |= {"response": "file", "path": "cra.csv"}
    picture = np.full((ROWS, COLUMNS), 7.0)
    bench, last = made(tmp_path, "microlens", params, picture, interval_mrad=3.0)
    y, x = (3e-3 * (np.arange(n) - (n - 1) / 2) for n in (ROWS, COLUMNS))
    height = np.hypot(x, y[:, np.newaxis]) / np.hypot(1.5e-3 * COLUMNS, 1.5e-3 * ROWS)
    away = np.degrees(np.arctan(height * np.tan(np.radians(28)))
                      + np.arctan(height * np.tan(np.radians(2))))  # fmt: skip
    found = bench.value(last)
    if measured:
        far = np.argmin(np.abs(away - 15.0))
        assert found.flat[far] == pytest.approx(7 * 0.9, abs=0.05)
        assert bench.readouts("microlens")["corner_percent"] == pytest.approx(40)
        return
    np.testing.assert_allclose(found, 7 * 2.0 ** -((away / 25) ** 2), rtol=1e-12)
    readouts = bench.readouts("microlens")
    assert readouts["corner_percent"] == pytest.approx(100 * 2 ** -((30 / 25) ** 2))
    assert readouts["mean_percent"] == pytest.approx(100 * found.mean() / 7)


def test_regions_are_those_of_the_whole(tmp_path):
    modules = {
        "microlens": {"chief_ray_deg": 20},
        "read_window": {"columns": 71, "rows": 90, "left": 4},
    }
    nodes = {"scene": ("test_scene", {"width": 90, "height": 131})}
    nodes |= {key: (key, params) for key, params in modules.items()}
    nodes["dual"] = ("dual_gain", {"switch_level": 4e-6, "blend_percent": 30, "low_factor": 0.5})
    links = [("scene.image", "microlens.image"), ("microlens.image", "read_window.image"),
             ("read_window.image", "dual.high"), ("read_window.image", "dual.low")]  # fmt: skip
    ports = ["microlens.image", "read_window.image", "dual.image"]
    assert_parts(linked_network(nodes, links), ports, tmp_path)
