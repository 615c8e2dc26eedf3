"""The default scene: the front of a student residence seen from across its lawn.

A dormitory was the target of Tantalo 1996, figure F.2. This one is drawn from continuous
coordinates, 0 to 1 in x and y, and so is the same building at every size of the picture.
"""

from __future__ import annotations

from nodes.scenes.building import draw_building
from nodes.scenes.grounds import (
    draw_car,
    draw_ground,
    draw_hills,
    draw_lamp,
    draw_sky,
    draw_tree,
)
from nodes.scenes.scene_canvas import Drawing

CARS = (
    (0.055, "car_cool", False),
    (0.185, "car_warm", False),
    (0.560, "car_warm", True),
    (0.690, "car_cool", False),
    (0.850, "car_warm", False),
)


def dormitory() -> Drawing:
    """Compose the scene, back to front, of the surfaces in `materials`."""
    drawing = Drawing("zenith")
    draw_sky(drawing)
    draw_hills(drawing)
    draw_building(drawing)
    draw_ground(drawing)
    for x, y, radius, foot, seed in (
        (0.520, 0.690, (0.026, 0.036), 0.765, 601),
        (0.640, 0.684, (0.028, 0.040), 0.770, 611),
        (0.265, 0.688, (0.026, 0.038), 0.768, 621),
        (0.955, 0.600, (0.075, 0.105), 0.785, 631),
    ):
        draw_tree(drawing, x=x, y=y, radius=radius, foot=foot, seed=seed)
    for left, body, running in CARS:
        draw_car(drawing, left=left, foot=0.832, body=body, running=running)
    for x in (0.292, 0.792):
        draw_lamp(drawing, x=x, foot=0.872)
    draw_tree(drawing, x=0.030, y=0.610, radius=(0.088, 0.140), foot=0.905, seed=641)
    return drawing
