"""Edges of the frame against a spatial sum; no transform at all."""

from __future__ import annotations

import numpy as np
import pytest

from analytic_stages import EFFICIENCY, INTERVAL_X, INTERVAL_Y, STAGES, TRANSFERS
from delivered_chains import MTF_ERROR, PRECISIONS, delivered, scene


def gaussian_matrix(size, sigma, pad):
    """Direct sum over every image of the frame, by the frame extended by `pad` samples."""
    n, m = np.arange(size)[:, np.newaxis], np.arange(-pad, size + pad)
    kernel = np.exp(-((n - m) ** 2) / (2 * sigma**2))
    # The spectrum beyond Nyquist is below 1e-14: the sampled kernel's sum is exact.
    return kernel / (sigma * np.sqrt(2 * np.pi))


def lag_matrix(size, pad):
    """Direct sum of the charge that `TRANSFERS` transfers leave behind."""
    lag = np.arange(size)[:, np.newaxis] - np.arange(-pad, size + pad)
    n = np.maximum(lag, 0)
    behind = EFFICIENCY**TRANSFERS * (1 - EFFICIENCY) ** n * (n + 1) * (n + 2) / 2
    return np.where(lag >= 0, behind, 0)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("edges", ["reflect", "periodic"])
@pytest.mark.parametrize("size", [(31, 17), (24, 10), (16, 1), (1, 9), (33, 48)], ids=str)
class TestDirectConvolution:
    """A spatial sum over the extended frame; no transform at all."""

    def test_gaussian(self, tmp_path, size, edges, precision, monkeypatch):
        sigma, pad = (2.7, 2.6), 24
        monkeypatch.setitem(STAGES, "blur", ("gaussian_mtf", {
            "sigma_x_mrad": sigma[1] * INTERVAL_X, "sigma_y_mrad": sigma[0] * INTERVAL_Y,
        }))  # fmt: skip
        picture = scene(*size)
        found, _ = delivered(tmp_path, picture, ("blur",), precision, edges)
        frame = np.pad(picture, pad, mode="symmetric" if edges == "reflect" else "wrap")
        along, across = (gaussian_matrix(n, s, pad) for n, s in zip(size, sigma, strict=True))
        expected = along @ frame @ across.T
        assert np.abs(found - expected).max() <= MTF_ERROR[precision] * np.abs(expected).max()

    def test_charge_left_behind(self, tmp_path, size, edges, precision):
        pad = 30
        picture = scene(*size)
        found, _ = delivered(tmp_path, picture, ("left", "late"), precision, edges)
        mode = "symmetric" if edges == "reflect" else "wrap"
        frame = np.pad(picture, ((0, 0), (pad, pad)), mode=mode)
        expected = frame @ lag_matrix(size[1], pad).T
        assert np.abs(found - expected).max() <= MTF_ERROR[precision] * np.abs(expected).max()
