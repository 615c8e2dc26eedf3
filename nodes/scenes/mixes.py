"""Radiances that are not known yet: a drawing names surfaces, and numbers come when it is shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

Radiances = Mapping[str, float]
"""Radiance by surface name [W m⁻² sr⁻¹]."""

Mix = Mapping[str, float]
"""Parts of named radiances: they sum to 1 for a surface, and to 0 for a difference."""


def between(first: str, second: str, share: float) -> Mix:
    """From `first` at 0 to `second` at 1."""
    return {first: 1.0 - share, second: share}


def difference(of: str, against: str) -> Mix:
    """How much more one surface has than another."""
    return {of: 1.0, against: -1.0}


def radiance_of(mix: Mix, radiances: Radiances) -> float:
    """Radiance of a mix."""
    return sum(part * radiances[name] for name, part in mix.items())


@dataclass(frozen=True)
class Texture:
    """How strong a texture is drawn.

    Parameters
    ----------
    name : str
        Stands for its strength, like a surface's for its radiance.
    amplitude : Mix
        Strength as given, before it is limited.
    reach : float
        Largest value of the texture at strength 1.
    limit : float
        The texture stays within this share of the least radiance among `surfaces`, so that no
        radiance falls below 0.
    surfaces : tuple of str
        The surface that it is on.
    """

    name: str
    amplitude: Mix
    reach: float
    limit: float
    surfaces: tuple[str, ...]

    def strength(self, radiances: Radiances) -> float:
        """What the texture is multiplied with."""
        given = radiance_of(self.amplitude, radiances)
        allowed = self.limit * min(radiances[name] for name in self.surfaces)
        reach = abs(given) * self.reach
        return given * allowed / reach if reach > allowed else given
