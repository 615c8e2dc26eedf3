"""Pictures without noise, and ranges whose end is no value."""

import json

import numpy as np
import pytest

from app.fit.chain_transfer import free_parameters
from app.fit.picture_fit import edges_in
from core.network.file import parse_network
from edge_truth import blur_network, gaussian_edge
from nodes.library import standard_library
from picture_samples import envi


def edge(noise, seed=1):
    return gaussian_edge(
        angle_deg=6.0, sigma=(0.6, 0.5), shape=(64, 64), points=6, noise=noise, seed=seed
    )


def test_an_edge_without_noise_is_fitted_as_one_with_little():
    (patch,), _ = edges_in(pictures=[edge(0.0)])
    (other,), _ = edges_in(pictures=[edge(1e-3)])
    assert len(patch.value) == len(other.value)
    assert patch.edge.angle_deg == pytest.approx(other.edge.angle_deg, abs=1e-3)


def test_zero_that_stands_for_an_empty_parameter_is_not_in_its_range():
    library = standard_library()
    network = parse_network(json.dumps(blur_network()), library=library)
    (free,) = free_parameters(["detector.fill_x=0:1"], network, library)
    assert 0.0 < free.low < 1e-9
    assert free.high == 1.0


# --- pictures of other cameras ---

MWIR = 3.0, 5.0


@pytest.fixture
def files(tmp_path):
    network = blur_network(blur=("gaussian_mtf", {"sigma_x_mrad": 0.06, "sigma_y_mrad": 0.05}))
    network["nodes"]["scene"]["params"] |= {"cut_on_um": MWIR[0], "cut_off_um": MWIR[1]}
    (tmp_path / "net.json").write_text(json.dumps(network), encoding="utf-8")
    picture = gaussian_edge(
        angle_deg=6.0, sigma=(0.6, 0.5), shape=(64, 64), levels=(1000, 4000), noise=20.0, seed=5
    )
    for name, centre, width in (("lwir", 10.0, 4.0), ("mwir", 4.0, 2.0), ("touching", 5.5, 1.0)):
        fields = {"wavelength": f"{{ {centre} }}", "fwhm": f"{{ {width} }}"}
        data = picture.astype("f8")[..., np.newaxis]
        envi(tmp_path / f"{name}.img", data, "bsq", wavelength_units="micrometers", **fields)
    np.save(tmp_path / "plain.npy", picture)
    return tmp_path


def fitted(files, works, name):
    done = works(
        "fit", "net.json", "--to", name, "--free", "blur.sigma_x_mrad", "--json", "fit.json"
    )
    return json.loads((files / "fit.json").read_text())["warnings"], done.stdout


def test_bands_that_do_not_overlap_are_warned_of(files, works):
    warnings, printed = fitted(files, works, "lwir.img")
    words = (
        "the picture lwir.img was taken in the band 8 to 12 µm, but the chain covers 3 to 5 µm: "
        "the fitted values do not describe the picture's camera"
    )
    assert any(line.startswith(words) for line in warnings)
    assert "band 8 to 12 µm" in printed
    for name in ("mwir.img", "touching.img", "plain.npy"):
        assert not any("µm" in line for line in fitted(files, works, name)[0]), name
