"""Bands of a picture as a viewer is answered: one, three as colours, and spectra. No Qt."""

import numpy as np
import pytest

from app.editor.evaluation.queries import Passing
from app.editor.viewers.picture.picture_facts import BandChoice, evenly_spaced
from app.editor.viewers.picture.picture_query import PictureQuery, facts_text, sample_text
from app.editor.viewers.picture.plots_below import MeanSpectrumQuery, SampleSpectrumQuery
from core.chain.engine import Engine
from core.evaluation.work import Policy
from core.network.file import load_network
from cube_files import band_by_band
from cube_network import BANDS, SIZE, write_cube_network
from nodes.library import standard_library

ONE = BandChoice("one", 4.25)
COLOURS = BandChoice("colours")


class CubeBench:
    """Answers queries on the network of a cube."""

    def __init__(self, folder, **how):
        library = standard_library()
        self.cube, self.wavelengths, self.width = write_cube_network(folder, library, **how)
        self.engine = Engine(library)
        network = load_network(folder / "cube.json", library=library)
        self.plan = self.engine.plan(network, folder=folder)
        self.work = self.engine.work(Policy("double", 0.0))

    def answer(self, query, plan=None):
        query.key(plan or self.plan)
        return query.answer(Passing(self.engine, plan or self.plan, self.work))

    def changed(self, node, name, value):
        return self.engine.plan(
            self.plan.network.with_parameter(node, name, value), folder=self.plan.folder
        )

    def kept(self):
        passing = Passing(self.engine, self.plan, self.work)
        return PictureQuery("read.image").kept_picture(passing)


@pytest.fixture
def bench(tmp_path):
    return CubeBench(tmp_path)


def test_one_band_behind_optics_is_blurred_at_its_own_wavelength(bench):
    picture = bench.answer(PictureQuery("back.image", bands=ONE))
    assert picture.facts.unit == "W/m²/sr/µm"
    assert picture.facts.quantity == "spectral radiance"
    low, high = picture.facts.band_um
    assert high - low == pytest.approx(bench.width)
    place = int(np.argmin(np.abs(bench.wavelengths - 4.25)))
    assert f"at {bench.wavelengths[place]:.4g} µm" in facts_text(
        picture, PictureQuery("back.image")
    )
    weights = (np.arange(BANDS) == place).astype(float)
    interval = np.radians(0.08) * 1e3 / SIZE[1]
    expected = band_by_band(
        bench.cube, bench.wavelengths, weights, interval_mrad=interval, aperture_mm=25.0
    )
    assert np.abs(picture.samples - expected).max() <= 1e-9 * np.ptp(expected)


def test_colours_each_between_levels_of_its_own(bench):
    picture = bench.answer(PictureQuery("read.image", levels="percentiles", bands=COLOURS))
    places = (10, 6, 2)  # of twelve, the middles of three equal parts
    assert evenly_spaced(BANDS) == places
    assert picture.grey.shape == (*SIZE, 3)
    for number, place in enumerate(places):
        band = bench.cube[place]
        low, high = np.quantile(band, (0.005, 0.995))
        wanted = np.clip((band - low) / (high - low) * 255, 0, 255)
        assert np.abs(picture.grey[..., number] - wanted).max() <= 0.51
        spread = picture.channels[number].spread
        assert spread.low == pytest.approx((band.min() - low) / (high - low), rel=1e-9)
        assert spread.counts.sum() == band.size
    assert picture.levels == (0.0, 1.0)
    red, green, blue = (bench.cube[place, 3, 5] for place in places)
    text = sample_text(picture, (3, 5))
    assert f"R {red:.5g}  G {green:.5g}  B {blue:.5g} W/m²/sr/µm" in text


@pytest.mark.parametrize("choice", [ONE, COLOURS])
def test_a_kept_picture_is_compared_band_by_band(bench, choice):
    """B is twice as bright as A, and A drawn by B's levels."""
    after = bench.changed("read", "scale", 2.0)
    query = PictureQuery("read.image", levels="percentiles", bands=choice, kept=bench.kept())
    now = bench.answer(query, after)
    place = {"one": int(np.argmin(np.abs(bench.wavelengths - 4.25))), "colours": 10}[choice.shown]
    assert now.refused == ""
    assert np.allclose(now.samples, 2 * bench.cube[place], rtol=1e-12)
    assert np.allclose(now.other.samples, bench.cube[place], rtol=1e-12)
    low, high = np.quantile(2 * bench.cube[place], (0.005, 0.995))
    wanted = np.clip((bench.cube[place] - low) / (high - low) * 255, 0, 255)
    drawn = now.other.grey if choice is ONE else now.other.grey[..., 0]
    assert np.abs(drawn - wanted).max() <= 0.51


def test_there_are_spectra_only_of_what_has_bands(bench):
    means = bench.answer(MeanSpectrumQuery("back.image"))
    assert means == pytest.approx(bench.cube.mean(axis=(1, 2)), rel=1e-12)
    assert bench.answer(SampleSpectrumQuery("read.image", SIZE[0], 0)) is None
    assert bench.answer(SampleSpectrumQuery("back.image", 7, 11)) is None
    assert bench.answer(MeanSpectrumQuery("fpa.image")) is None
    plain = bench.answer(PictureQuery("fpa.image"))
    for choice in (ONE, COLOURS):
        picture = bench.answer(PictureQuery("fpa.image", bands=choice))
        assert picture.samples is plain.samples
        assert picture.facts == plain.facts
