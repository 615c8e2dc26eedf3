"""How far colours differ, to usual sight and without one kind of cone, and whether text is read.

Sources
-------
G. Sharma, W. Wu, E. N. Dalal, "The CIEDE2000 color-difference formula: implementation notes,
supplementary test data, and mathematical observations", Color Research and Application 30 (2005).
G. M. Machado, M. M. Oliveira, L. A. F. Fernandes, "A physiologically-based model for simulation of
color vision deficiency", IEEE Trans. Visualization and Computer Graphics 15 (2009), severity 1.0.
Web Content Accessibility Guidelines 2.1, "relative luminance" and "contrast ratio".
"""

import math

import numpy as np

SIGHTS = {
    "usual": np.eye(3),
    "protan": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deutan": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    "tritan": np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
_TO_XYZ = np.array(  # sRGB, IEC 61966-2-1, white D65
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)
_WHITE = _TO_XYZ @ np.ones(3)


def linear(name):
    """Light of red, green and blue of ``#rrggbb``, 0 to 1."""
    coded = np.array([int(name[place : place + 2], 16) for place in (1, 3, 5)]) / 255.0
    return np.where(coded <= 0.04045, coded / 12.92, ((coded + 0.055) / 1.055) ** 2.4)


def lab(name, sight="usual"):
    """CIE L*a*b* of a colour as it looks to a sight."""
    light = np.clip(SIGHTS[sight] @ linear(name), 0.0, 1.0)
    ratios = (_TO_XYZ @ light) / _WHITE
    x, y, z = (
        value ** (1 / 3) if value > 216 / 24389 else (24389 / 27 * value + 16) / 116
        for value in ratios.tolist()
    )
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def ciede2000(one, other):
    """The difference of two colours in L*a*b*; the steps are those of Sharma et al."""
    (l1, a1, b1), (l2, a2, b2) = one, other
    mean = (math.hypot(a1, b1) + math.hypot(a2, b2)) / 2
    stretch = 1.5 - 0.5 * math.sqrt(mean**7 / (mean**7 + 25.0**7))
    a1, a2 = stretch * a1, stretch * a2
    c1, c2 = math.hypot(a1, b1), math.hypot(a2, b2)
    h1, h2 = (math.degrees(math.atan2(b, a)) % 360 for a, b in ((a1, b1), (a2, b2)))
    dh = (h2 - h1 + 180) % 360 - 180 if c1 * c2 else 0.0
    if h2 - h1 == 180:
        dh = 180.0
    big_h = 2 * math.sqrt(c1 * c2) * math.sin(math.radians(dh / 2))
    lm, cm = (l1 + l2) / 2, (c1 + c2) / 2
    if not c1 * c2:
        hm = h1 + h2
    elif abs(h1 - h2) <= 180:
        hm = (h1 + h2) / 2
    else:
        hm = (h1 + h2 + (360 if h1 + h2 < 360 else -360)) / 2
    t = (
        1
        - 0.17 * math.cos(math.radians(hm - 30))
        + 0.24 * math.cos(math.radians(2 * hm))
        + 0.32 * math.cos(math.radians(3 * hm + 6))
        - 0.20 * math.cos(math.radians(4 * hm - 63))
    )
    turn = 60 * math.exp(-(((hm - 275) / 25) ** 2))
    weight_l = 1 + 0.015 * (lm - 50) ** 2 / math.sqrt(20 + (lm - 50) ** 2)
    weight_c, weight_h = 1 + 0.045 * cm, 1 + 0.015 * cm * t
    twist = -math.sin(math.radians(turn)) * 2 * math.sqrt(cm**7 / (cm**7 + 25.0**7))
    dl, dc, dh = (l2 - l1) / weight_l, (c2 - c1) / weight_c, big_h / weight_h
    return math.sqrt(dl**2 + dc**2 + dh**2 + twist * dc * dh)


def difference(one, other, sight="usual"):
    """How far two colours differ to a sight."""
    return ciede2000(lab(one, sight), lab(other, sight))


def contrast(one, other):
    """The contrast ratio of text and ground, 1 to 21."""
    lights = [float(np.array([0.2126, 0.7152, 0.0722]) @ linear(name)) for name in (one, other)]
    return (max(lights) + 0.05) / (min(lights) + 0.05)


def mixed(top, ground, opacity):
    """A colour painted with that opacity over another, as ``#rrggbb``."""
    parts = [
        round(opacity * int(top[n : n + 2], 16) + (1 - opacity) * int(ground[n : n + 2], 16))
        for n in (1, 3, 5)
    ]
    return "#" + "".join(f"{part:02x}" for part in parts)
