"""Pictures of edges and lines whose MTF is known: blurred, then averaged over pixels."""

import math

import numpy as np
from scipy.special import erf

PHASE = 0.3  # samples from the middle of the picture: no symmetry to hide behind
_WITHIN = 16  # Gauss–Legendre points across a pixel


def edge_picture(angle_deg, sigma, size=(64, 64), phase=PHASE):
    """A step from 0 to 1, blurred by a Gaussian of `sigma` samples and averaged over pixels.

    The normal points `angle_deg` from the rows. Along a row the mean over the pixel is exact, from
    the antiderivative of the error function; down it, by quadrature.
    """
    away, cosine, weights = _distances(angle_deg, size, phase)
    half = cosine / 2
    along = (_ramp(away + half, sigma) - _ramp(away - half, sigma)) / cosine
    return np.tensordot(weights, along, 1)


def edge_mtf(frequency, angle_deg, sigma):
    """MTF of Gaussian and pixel along the edge's normal, cycles per sample."""
    angle = math.radians(angle_deg)
    pixel = np.sinc(frequency * math.cos(angle)) * np.sinc(frequency * math.sin(angle))
    return np.abs(pixel) * np.exp(-2 * (np.pi * sigma * frequency) ** 2)


def _distances(angle_deg, size, phase):
    angle = math.radians(angle_deg)
    points, weights = np.polynomial.legendre.leggauss(_WITHIN)
    y = np.arange(size[0])[:, None] - (size[0] - 1) / 2
    x = np.arange(size[1]) - (size[1] - 1) / 2
    down = y + points[:, None, None] / 2
    away = x * math.cos(angle) - down * math.sin(angle) - phase
    return away, math.cos(angle), weights / 2


def _step(away, sigma):
    return (1 + erf(away / (sigma * math.sqrt(2)))) / 2


def _ramp(away, sigma):
    bell = np.exp(-((away / sigma) ** 2) / 2) / math.sqrt(2 * math.pi)
    return away * _step(away, sigma) + sigma * bell
