"""Chains opened, built, changed and run; what they deliver is what the command writes."""

import json
import pickle
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import imagechain as ic
from command_line import run_here
from core.machine import is_on_disk
from core.network.file import load_network
from nodes.files.formats import read_info, read_pixels
from nodes.library import standard_library

SNR = "electronics.amplifier_snr"


@pytest.fixture(scope="module")
def kodak():
    """The Kodak network on a small scene, run once."""
    chain = ic.open("kodak_kir310")
    chain.set({"scene.width": 128, "scene.height": 128, SNR: 40})
    return chain, chain.run()


def built(scene, sigma=0.3):
    chain = ic.Chain("Mine", seed=7)
    chain.add(scene)
    chain.add(ic.modules.init_trans(f_number=2, focal_length_mm=100), name="init")
    chain.add(ic.modules.gaussian_mtf(sigma_x_mrad=sigma, sigma_y_mrad=sigma), name="blur")
    chain.add(ic.modules.back_transform(), name="back")
    return chain


def pixels(rows=24, columns=32, dtype=np.float32):
    return np.random.default_rng(3).random((rows, columns)).astype(dtype)


def test_a_shipped_network_gives_what_the_command_writes(kodak, tmp_path, monkeypatch):
    _, result = kodak
    monkeypatch.chdir(tmp_path)
    words = ["--set", "scene.width=128", "--set", "scene.height=128", "--set", f"{SNR}=40"]
    port = "frame_grabber.image"
    done = run_here("run", "kodak_kir310", *words, "--save", f"{port}=quiet.npy", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    written = np.load(tmp_path / "quiet.npy")
    assert result.final == port
    assert result.image().tobytes() == result.images[port].tobytes() == written.tobytes()
    assert len(result.images) == len([*result.images])
    assert result.image().dtype == written.dtype
    assert not result.image().flags.writeable
    folder = tmp_path / "kodak_kir310-output"
    figures = json.loads((folder / "readouts.json").read_text("utf-8"))
    cautions = figures.pop("imagechain.warnings")
    assert result.readouts.to_dict() == figures
    assert sum(map(len, cautions.values())) == len(result.warnings) > 0
    table = np.genfromtxt(folder / "mtf.csv", delimiter=",", names=True)
    total = result.curves()["total"]["x"]
    np.testing.assert_array_equal(total.frequency, table["xi_cyc_per_mrad"])
    np.testing.assert_array_equal(total.mtf, table["totalmtf_x"])
    assert result.save("again.npy").exists()
    assert (tmp_path / "again.npy").read_bytes() == (tmp_path / "quiet.npy").read_bytes()


def test_a_change_repeats_only_what_follows_it(kodak):
    chain, before = kodak
    other = chain.with_({SNR: 20})
    assert chain[SNR.partition(".")[0]].amplifier_snr == 40
    assert other.get(SNR) == 20
    after = other.run()
    assert "electronics" in after.seconds
    assert not {"scene", "back"} & set(after.seconds)
    assert (before.image() != after.image()).any()
    again = chain.run()
    assert again.image() is before.image() or np.array_equal(again.image(), before.image())
    fresh = ic.open("kodak_kir310").set({"scene.width": 128, "scene.height": 128, SNR: 20}).run()
    assert fresh.image().tobytes() == after.image().tobytes()


def test_options_of_a_run(kodak):
    chain, whole = kodak
    part = chain.run(region=np.s_[10:20, 5:25], outputs=["frame_grabber.image"])
    np.testing.assert_array_equal(part.image(), whole.image()[10:20, 5:25])
    two = chain.run(frames=2).image()
    assert two.shape == (2, *whole.image().shape)
    np.testing.assert_array_equal(two[0], whole.image())
    assert (two[1] != two[0]).any()
    assert chain.run(precision="double").image().dtype == np.float64
    assert (chain.run(seed=3).image() != whole.image()).any()
    for named, message in (
        ({"region": np.s_[10:10, :]}, "region = "),
        ({"region": 3}, "region = 3 is not allowed: must be two slices"),
        ({"memory": "much"}, "memory 'much' is not allowed: must be a size such as 2GB"),
        ({"precision": "half"}, "precision = 'half' is not allowed: must be single or double"),
        ({"outputs": ["back.picture"]}, "back.picture: back has no output 'picture'"),
    ):
        with pytest.raises(ic.ImagechainError) as caught:
            chain.run(**named)
        assert str(caught.value).startswith(message)


def test_pictures_that_memory_is_not_to_hold_lie_on_disk(tmp_path):
    chain = built(ic.scene(pixels(64, 48), fov_x_deg=1, fov_y_deg=1))
    whole = chain.run()
    fresh = pickle.loads(pickle.dumps(chain))
    blocks = fresh.run(memory="20kB", scratch=tmp_path)
    assert is_on_disk(blocks.image())
    assert not is_on_disk(whole.image())
    assert blocks.image().tobytes() == whole.image().tobytes()
    assert blocks.readouts.to_dict() == whole.readouts.to_dict()
    assert blocks.picture().to_png() == whole.picture().to_png()
    with pytest.raises(ic.ParameterError, match="frames = 2 is not allowed: must be 1 for"):
        fresh.run(memory="20kB", frames=2)
    assert not is_on_disk(fresh.run().image())


def test_a_chain_built_in_ten_lines_is_wired_as_the_editor_would():
    chain = built(ic.scene(pixels(), fov_x_deg=1, fov_y_deg=1, band_um=(8, 12)))
    assert set(chain.links) == {
        ("scene.image", "init.image"),
        ("init.context", "blur.context"),
        ("init.magnitude", "blur.magnitude"),
        ("blur.magnitude", "back.magnitude"),
        ("init.phase", "back.phase"),
    }
    chain.add(ic.modules.examine_image(), name="look")
    chain.add(ic.modules.exit_pupil(), name="pupil", after="init")
    chain.add(ic.modules.exit_pupil_mtf(), name="optics", after="blur")
    chain.add(ic.modules.poisson_noise(), name="noise")  # behind back: nothing carries it on
    links = set(chain.links)
    assert ("back.image", "noise.image") in links
    assert {("blur.magnitude", "optics.magnitude"), ("optics.magnitude", "back.magnitude")} <= links
    assert {("pupil.pupil", "optics.pupil"), ("init.context", "optics.context")} <= links
    assert {("init.phase", "optics.phase"), ("optics.phase", "back.phase")} <= links
    assert not {("blur.magnitude", "back.magnitude"), ("init.phase", "back.phase")} & links
    assert chain.check().ok, chain.check()
    assert chain.run().final == "noise.image"
    chain.remove("optics").link("blur.magnitude", "back.magnitude").remove("pupil")
    chain.link("init.phase", "back.phase")
    assert chain.rename("noise", "shot")["shot"].module == "poisson_noise"
    assert chain.check().ok


def test_a_preset_is_one_node():
    chain = built(ic.scene(pixels(), fov_x_deg=1, fov_y_deg=1, band_um=(8, 12)))
    lens = chain.add(ic.preset("lens_flir_tau2_25mm", defocus_waves=0.25), after="blur")
    assert ("blur.magnitude", "lens.magnitude") in chain.links
    assert ("lens.phase", "back.phase") in chain.links
    assert (lens.defocus_waves, chain["lens/optics"].size_x_cm) == (0.25, 3.2323)
    first = chain.run()
    assert "lens/optics" in first.readouts
    chain.set({"lens.defocus_waves": 0, "lens/optics.size_x_cm": 3})
    assert chain.get("lens/pupil.defocus_waves") == 0
    assert (chain.run().image() != first.image()).any()
    again = pickle.loads(pickle.dumps(lens.part))
    assert (again.name, dict(again.params)) == ("lens", {"defocus_waves": 0.0})
    assert "lens_flir_tau2_25mm" in ic.presets()
    with pytest.raises(ic.NetworkError, match="there is no preset lens; the presets are camera"):
        ic.preset("lens")


def test_what_fits_nowhere_is_refused_in_one_line():
    chain = ic.Chain()
    chain.add(ic.modules.test_scene(), name="scene")
    with pytest.raises(ic.NetworkError) as caught:
        chain.add(ic.modules.back_transform(), name="back")
    assert str(caught.value).startswith("back (Back Transform) takes magnitude or phase")
    assert caught.value.__cause__ is None
    assert list(chain) == ["scene"]
    node = chain.add(ic.modules.back_transform(), name="back", wired=False)
    assert node.inputs == ("back.magnitude", "back.phase")
    assert "input magnitude needs a link" in str(chain.check().errors[0])
    with pytest.raises(
        ic.NetworkError, match=r"scene\.image gives image, but back\.magnitude takes"
    ):
        chain.link("scene.image", "back.magnitude")


def test_a_scene_from_an_array_is_that_of_a_file(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    samples = pixels()
    chain = built(ic.scene(samples, fov_x_deg=1, fov_y_deg=1.5, band_um=(3, 5)))
    np.save("scene.npy", samples)
    read = ic.modules.read_image(
        path="scene.npy", fov_x_deg=1, fov_y_deg=1.5, cut_on_um=3, cut_off_um=5
    )
    truth = built(read).run()
    result = chain.run()
    samples[:] = 0  # the chain has a copy
    assert chain.run().image().tobytes() == result.image().tobytes() == truth.image().tobytes()
    assert result.picture().band_um == (3.0, 5.0)
    chain.save(tmp_path / "mine.json")
    done = run_here("run", "mine.json", "--save", "back.image=out.npy", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert np.load("out.npy").tobytes() == result.image().tobytes()
    document = load_network(tmp_path / "mine.json", library=standard_library())
    assert document.nodes["scene"].params["path"] == "mine_scene.npy"
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / "elsewhere" / "mine_scene.npy").write_bytes(b"precious")
    with pytest.raises(ic.FileError, match=r"mine_scene\.npy already exists"):
        chain.save("elsewhere/mine.json")
    assert (tmp_path / "elsewhere" / "mine_scene.npy").read_bytes() == b"precious"
    chain.save("mine.json")  # over its own


@pytest.mark.parametrize(
    ("array", "message"),
    [
        (np.array([[1.0, np.nan]]), "the array: 1 sample is not finite"),
        ([[1.0, 2.0], [3.0]], "the array cannot be converted to numbers"),
        (np.ma.masked_less(np.eye(2), 0.5), "the array has masked samples"),
    ],
)
def test_what_is_no_picture_is_refused(array, message):
    with pytest.raises(ic.DataError) as caught:
        ic.scene(array)
    assert str(caught.value).startswith(message)


def test_pictures_as_xarray_and_back():
    xarray = pytest.importorskip("xarray")
    result = built(ic.scene(pixels(), fov_x_deg=1, fov_y_deg=2, unit="K", band_um=(8, 12))).run()
    picture = result.picture()
    array = picture.to_xarray()
    assert (array.dims, array.attrs["units"]) == (("y", "x"), "K")
    steps = np.diff(array.coords["x"]), np.diff(array.coords["y"])
    np.testing.assert_allclose(steps[0], np.deg2rad(1) * 1000 / 32, rtol=1e-12)
    np.testing.assert_allclose(steps[1], np.deg2rad(2) * 1000 / 24, rtol=1e-12)
    again = ic.scene(array.transpose("x", "y"))
    assert again.samples.key == ic.scene(picture.samples).samples.key
    assert again.params["unit"] == "K"
    assert (again.params["cut_on_um"], again.params["cut_off_um"]) == (8.0, 12.0)
    assert again.params["fov_x_deg"] == pytest.approx(1, rel=1e-14)
    assert again.params["fov_y_deg"] == pytest.approx(2, rel=1e-14)
    bare = xarray.DataArray(
        np.ones((2, 3)), coords={"x": ("x", [0.0, 0.1, 0.2], {"units": "deg"})}, dims=("y", "x")
    )
    assert ic.scene(bare).params["fov_x_deg"] == pytest.approx(0.3)
    with pytest.raises(ic.DataError, match="coordinate x is not evenly spaced"):
        ic.scene(bare.assign_coords(x=("x", [0.0, 0.1, 0.3], {"units": "deg"})))


def test_figures_and_curves_as_frames(kodak):
    pytest.importorskip("pandas")
    _, result = kodak
    frame = result.readouts.to_frame()
    value = result.readouts["electronics"]["netd_system_K"]
    assert frame.loc[("electronics", "netd_system_K"), "value"] == value
    assert frame.loc[("electronics", "netd_system_K"), "unit"] == "K"
    curves = result.curves()
    table = curves.to_frame()
    chosen = table[(table["stage"] == "total") & (table["axis"] == "y")]
    np.testing.assert_array_equal(chosen["mtf"], curves["total"]["y"].mtf)
    assert curves.total is not None
    line = result.curves(angle_deg=0)["total"]["line"]
    np.testing.assert_allclose(line.mtf, curves["total"]["x"].mtf, atol=1e-12)


def test_macros_expressions_and_bands_pass_through():
    chain = ic.open("dirsig_cube")
    chain.run(outputs=[])
    picture = chain.run(outputs=["scene.image"]).picture("scene.image")
    assert len(picture.wavelengths_um) == 16
    total = sum(picture.band(index) * 1.0 for index in range(16))
    assert total.shape == picture.shape
    blurred = built(ic.scene(pixels(), fov_x_deg=1, fov_y_deg=1))
    blurred["blur"].sigma_x_mrad = ic.expression("init.f_number * 0.05")
    blurred["blur"].sigma_y_mrad = "=300 urad"
    assert (blurred["blur"].sigma_x_mrad, blurred["blur"].sigma_y_mrad) == (0.1, 0.3)
    assert "0.1 (= init.f_number * 0.05)  mrad" in repr(blurred["blur"])
    truth = blurred.with_({"blur.sigma_x_mrad": 0.1, "blur.sigma_y_mrad": 0.3}).run()
    assert blurred.run().image().tobytes() == truth.image().tobytes()
    assert pickle.loads(pickle.dumps(blurred)).run().image().tobytes() == truth.image().tobytes()


def test_a_cube_from_an_array_is_that_of_a_file(tmp_path, monkeypatch):
    xarray = pytest.importorskip("xarray")
    monkeypatch.chdir(tmp_path)
    cube = np.random.default_rng(2).random((5, 8, 9))
    waves = np.array([3.1, 3.4, 3.9, 4.2, 4.8])
    chain = ic.Chain(seed=1)
    part = ic.scene(cube, wavelengths_um=waves, fov_x_deg=1, fov_y_deg=1, band_um=(3.3, 4.9))
    chain.add(part)
    picture = chain.run(precision="double").picture()
    # Trapezoids about each band; the second is cut at 3.3 µm, the last at 4.9 µm.
    edges = np.array([3.3, 3.65, 4.05, 4.5, 4.9])
    truth = np.tensordot(np.diff(edges), cube[1:], 1)
    np.testing.assert_allclose(picture.samples, truth, rtol=1e-12)
    assert picture.wavelengths_um[1:3] == (3.9, 4.2)
    np.testing.assert_allclose(picture.cube(), cube[1:], rtol=1e-15)
    chain.save("cube.json")
    read = ic.open("cube.json").run(precision="double")
    assert read.image().tobytes() == picture.samples.tobytes()
    assert ic.open("cube.json").get("scene.path") == Path("cube_scene.img")
    array = picture.to_xarray(bands=True)
    assert (array.dims, array.attrs["units"]) == (("wavelength", "y", "x"), "W/m²/sr/µm")
    again = ic.scene(array.transpose("x", "y", "wavelength"))
    np.testing.assert_array_equal(again.samples.samples, picture.cube())
    assert again.samples.wavelengths_um == picture.wavelengths_um
    chain.run(precision="double").save("again.img")
    info = read_info("again.img")
    assert (info.bands, info.unit, info.wavelengths_um[1:3]) == (4, "W/m^2/sr/um", (3.9, 4.2))
    np.testing.assert_allclose(read_pixels("again.img", 1), cube[2], rtol=1e-15)
    with pytest.raises(
        ic.DataError, match="wavelengths_um has 4 numbers, but the array has 5 bands"
    ):
        ic.scene(cube, wavelengths_um=waves[1:])
    with pytest.raises(ic.DataError, match="has no wavelengths"):
        ic.scene(xarray.DataArray(cube, dims=("band", "y", "x")))


def test_runs_from_several_threads_at_once():
    chain = built(ic.scene(pixels(), fov_x_deg=1, fov_y_deg=1))
    chain.add(ic.modules.poisson_noise(photons_per_unit=100))
    chains = [chain.with_({"blur.sigma_x_mrad": 0.1 * (n + 1)}, seed=n % 3) for n in range(8)]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda one: one.run().image().tobytes(), chains))
    alone = [pickle.loads(pickle.dumps(one)).run().image().tobytes() for one in chains]
    assert together == alone


def test_errors_are_the_commands_one_line(tmp_path):
    chain = ic.open("first_steps")
    for place, value, message in (
        (
            "blur.sigma_x_mrad",
            -1,
            "blur: sigma_x_mrad = -1 mrad is not allowed: must be a number of",
        ),
        ("blur.sigma_x", 1, "blur: sigma_x = 1 is not allowed: Gaussian MTF has no such param"),
        ("blurr.sigma_x_mrad", 1, "blurr is not a node of this network; did you mean blur?"),
        ("sigma", 1, "sigma is not a parameter: write NODE.PARAMETER"),
    ):
        with pytest.raises(ic.ImagechainError) as caught:
            chain.set({"scene.width": 99, place: value})
        assert str(caught.value).startswith(message)
        assert caught.value.__cause__ is None
        assert len(caught.traceback) == 2  # here, and where it was called
    assert chain["scene"].width == 512  # all or nothing
    done = run_here("run", "first_step", folder=tmp_path)
    with pytest.raises(ic.FileError) as caught:
        ic.open("first_step")
    assert done.stderr.strip() == f"imagechain: {caught.value}"
    missing = built(ic.modules.read_image(path=str(tmp_path / "none.npy")))
    with pytest.raises(ic.ImagechainError, match=r"read_image: .*none\.npy: no such file"):
        missing.run()


def test_a_chain_with_an_unknown_module_is_shown_and_saved_as_it_is(tmp_path):
    document = json.loads(ic.open("first_steps").to_json())
    document["nodes"]["blur"] = {"module": "far_away", "params": {"a": 3}}
    (tmp_path / "n.json").write_text(json.dumps(document), encoding="utf-8")
    chain = ic.open(tmp_path / "n.json")
    assert "far_away" in repr(chain)
    assert repr(chain["blur"]).splitlines() == ["<blur: far_away>", "  a  3"]
    assert str(chain.check().errors[0]).startswith("blur: there is no module far_away")
    with pytest.raises(ic.NetworkError, match="blur: there is no module far_away"):
        chain.run()
    assert json.loads(chain.to_json()) == document
    document["nodes"]["blur"]["module"] = "acme_optics.far_away"
    (tmp_path / "n.json").write_text(json.dumps(document), encoding="utf-8")
    with pytest.raises(ic.NetworkError, match="the package acme_optics, which is not installed"):
        ic.open(tmp_path / "n.json").set("blur.a", 4)


def test_files_of_write_nodes(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    chain = built(ic.scene(pixels(), fov_x_deg=1, fov_y_deg=1))
    chain.add(ic.modules.write_image(path="out.npy", format="npy"), name="out")
    result = chain.run()
    assert not (tmp_path / "out.npy").exists()
    (file,) = result.write_files()
    assert np.load(file).tobytes() == result.image("back.image").tobytes()
    (tmp_path / "here").mkdir()
    chain.save("here/mine.json")
    stranger = ic.open("here/mine.json").run()
    with pytest.raises(ic.FileError, match=r"out: cannot write .*write_files\(allow=\["):
        stranger.write_files()
    assert stranger.write_files(allow=[tmp_path])


def test_pages_of_notebooks_show_no_text_as_html(kodak):
    _, result = kodak
    chain = built(ic.scene(pixels(), fov_x_deg=1, fov_y_deg=1))
    chain.name = "<script>alert(1)</script>"
    chain.rename("blur", "<b>&")
    made = chain.run()
    shown = [
        chain,
        chain["<b>&"],
        made,
        made.picture(),
        made.readouts,
        made.curves(),
        chain.check(),
    ]
    for page in (one._repr_html_() for one in [*shown, result]):
        assert page.startswith("<")
        assert "<script" not in page
        assert "<b>" not in page
    assert "&lt;b&gt;&amp;" in chain._repr_html_()
    assert "data:image/png;base64," in made._repr_html_()


def test_a_part_finds_its_files_in_another_chain():
    there = ic.open("measured_lens")
    part = there.part("psf")
    (path,) = [value for name, value in part.params.items() if name == "path"]
    assert Path(path).is_file()
    assert ic.Chain().add(part, wired=False).name == "psf"


# --- a picture in place of the scene -----------------------------------------------------------


def test_an_array_takes_the_place_of_the_scene():
    chain = ic.open("first_steps")
    levels = np.arange(48, dtype=np.uint8).reshape(6, 8)
    before = chain.run(outputs=["scene.image"]).image("scene.image")
    low, high = float(before.min()), float(before.max())
    chain.scene = levels
    assert chain.scene[0] == "an array, 8 × 6 samples, replaces Test Scene"
    found = chain.run().image("scene.image")
    np.testing.assert_allclose(found, low + (high - low) * levels / 255.0, rtol=1e-6)
    interval = chain.run().readouts["init"]["interval_x_mrad"]
    assert interval == pytest.approx(1000 * np.radians(10.0) / 8)
    copied = pickle.loads(pickle.dumps(chain))
    assert copied.scene == chain.scene


def test_a_file_takes_the_place_of_the_scene(tmp_path, monkeypatch):
    kelvin = 290.0 + np.arange(48.0).reshape(6, 8) / 8
    np.save(tmp_path / "own.npy", kelvin)
    monkeypatch.chdir(tmp_path)
    chain = ic.open("first_steps")
    words = {"fov_deg": (4.0, 3.0), "band_um": (8.0, 12.0), "unit": "K"}
    assert chain.replace_scene("own.npy", **words) is chain
    other = ic.open("first_steps").replace_scene(kelvin, **words)
    ours, theirs = (one.run().image("to_radiance.image") for one in (chain, other))
    np.testing.assert_array_equal(ours, theirs)
    chain.save(tmp_path / "mine.json")
    again = ic.open(tmp_path / "mine.json").run().image("to_radiance.image")
    np.testing.assert_array_equal(again, ours)
    with pytest.raises(ic.UsageError, match="fov_deg 0 is not allowed: must be above 0°"):
        chain.replace_scene("own.npy", fov_deg=(0.0, 1.0))
    with pytest.raises(ic.ImagechainError, match="7 is not a picture: give a file or"):
        chain.scene = 7


def test_figures_are_computed_when_they_are_asked_for():
    chain = ic.open("mwir_camera").set({"scene.width": 32, "scene.height": 32})
    result = chain.run()
    assert not {"merit", "budget"} & set(result.seconds)
    assert result.readouts["merit"]
    assert "merit" in result.seconds
    chain = ic.open("first_steps")
    chain.add(ic.modules.measured_mtf(), name="judge", after="back")
    chain.scene = np.zeros((96, 128))
    result = chain.run()
    with pytest.warns(UserWarning, match="judge is left out: no edge found"):
        assert "judge" not in result.readouts
    assert result.image("back.image").shape == (96, 128)


def test_a_module_added_after_a_node_comes_before_all_that_follow_it():
    chain = ic.open("mwir_camera")
    chain.add(ic.modules.gaussian_mtf(sigma_x_mrad=0.1), name="soft", after="detector")
    ends = {end for start, end in chain.links if start == "soft.magnitude"}
    assert ends == {"back.magnitude", "slices.transfer"}
    assert {end for start, end in chain.links if start == "detector.magnitude"} == {
        "soft.magnitude"
    }
    chain.add(ic.modules.examine_image(), name="look", after="focal_plane")  # leads to nothing
    ends = {end for start, end in chain.links if start == "focal_plane.image"}
    assert ends == {"budget.image", "merit.image", "look.image"}
