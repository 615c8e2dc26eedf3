"""The preview of a module that gives a picture: the picture, small, and what it is."""

from core.chain.engine import PlannedNode
from core.chain.wires import Image
from core.evaluation.work import Work
from core.modules.declaration import Module, NodeContext
from core.modules.preview import Picture, Preview, brief, pair


class PicturePreview(Module):
    """A module whose output `image` is shown at the top of its panel."""

    preview_lines = 10.0

    def preview(self, planned: PlannedNode, work: Work, _here: NodeContext) -> Preview:
        image: Image = planned.sound().outputs["image"]
        samples = work.value(image.recipe)
        x, y = image.interval_x_mrad, image.interval_y_mrad
        low, high = float(samples.min()), float(samples.max())
        facts = [
            f"{image.columns} × {image.rows} samples",
            f"{brief(low)} to {brief(high)} {image.unit}".rstrip(),
            "no field of view" if x is None or y is None else f"interval {pair(x, y)} mrad",
        ]
        if image.band_um is not None:
            facts.append(f"{brief(image.band_um[0])} to {brief(image.band_um[1])} µm")
        picture = Picture(samples, low, high, _shape(image))
        return Preview(", ".join(facts), (picture,), tuple(facts))


def _shape(image: Image) -> tuple[float, float]:
    """Width and height as they are seen: in mrad where both intervals are known."""
    x, y = image.interval_x_mrad, image.interval_y_mrad
    if x is None or y is None or not 0.1 < (x * image.columns) / (y * image.rows) < 10:
        return float(image.columns), float(image.rows)
    return x * image.columns, y * image.rows
