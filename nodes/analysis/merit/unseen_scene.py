"""What stands in place of figures where a picture is clipped and shows nothing of its scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from core.chain.results import CurveData
from core.errors import DataError
from core.lineage.linear_change import LevelChange


@dataclass(frozen=True)
class Unseen:
    """Why there are no figures: the rest of the network is delivered all the same."""

    reason: str

    def curve(self, title: str, x_label: str, y_label: str) -> CurveData:
        """A plot without curves."""
        return CurveData(title, x_label, y_label, ())


def unseen(gain: float, levels: Sequence[LevelChange], consequence: str) -> Unseen | None:
    """Whether a picture follows the scene; None where it does.

    Parameters
    ----------
    gain : float
        From the scene to the picture.
    levels : sequence of LevelChange
        Of which one may have the reason.
    consequence : str
        What cannot be had of the picture.

    Raises
    ------
    DataError
        If it does not, and none of the changes says why.
    """
    if gain > 0.0:
        return None
    reason = next((level.reason for level in levels if level.reason), "")
    if not reason:
        raise DataError(f"the picture does not change with the scene: {consequence}")
    return Unseen(f"{reason}: {consequence}")
