"""The default scene: the front of a student residence seen from across its lawn.

A dormitory was the target of Tantalo 1996, figure F.2. This one is drawn from continuous
coordinates, 0 to 1 in x and y, and so is the same building at every size of the picture.
"""

from __future__ import annotations

from nodes.scenes.building import draw_building
from nodes.scenes.canvas import Drawing
from nodes.scenes.grounds import (
    draw_car,
    draw_ground,
    draw_hills,
    draw_lamp,
    draw_sky,
    draw_tree,
)
from nodes.scenes.materials import surface_radiance

CARS = (
    (0.055, "car_cool", False),
    (0.185, "car_warm", False),
    (0.560, "car_warm", True),
    (0.690, "car_cool", False),
    (0.850, "car_warm", False),
)


def dormitory(
    *, cut_on_um: float, cut_off_um: float, temperature_K: float, delta_K: float
) -> Drawing:
    """Compose the scene, back to front.

    Parameters
    ----------
    cut_on_um, cut_off_um : float
        Band [µm].
    temperature_K, delta_K : float
        Air temperature [K] and the step in which surfaces differ from it [K].

    Returns
    -------
    Drawing
        Radiance [W m⁻² sr⁻¹] over the frame.

    Raises
    ------
    ParameterError
        If delta_K puts a surface at or below 0 K.
    """
    L = surface_radiance(
        cut_on_um=cut_on_um,
        cut_off_um=cut_off_um,
        temperature_K=temperature_K,
        delta_K=delta_K,
    )
    drawing = Drawing(L["zenith"])
    draw_sky(drawing, L)
    draw_hills(drawing, L)
    draw_building(drawing, L)
    draw_ground(drawing, L)
    for x, y, radius, foot, seed in (
        (0.520, 0.690, (0.026, 0.036), 0.765, 601),
        (0.640, 0.684, (0.028, 0.040), 0.770, 611),
        (0.265, 0.688, (0.026, 0.038), 0.768, 621),
        (0.955, 0.600, (0.075, 0.105), 0.785, 631),
    ):
        draw_tree(drawing, L, x=x, y=y, radius=radius, foot=foot, seed=seed)
    for left, body, running in CARS:
        draw_car(drawing, L, left=left, foot=0.832, body=body, running=running)
    for x in (0.292, 0.792):
        draw_lamp(drawing, L, x=x, foot=0.872)
    draw_tree(drawing, L, x=0.030, y=0.610, radius=(0.088, 0.140), foot=0.905, seed=641)
    return drawing
