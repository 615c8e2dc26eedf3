"""Which periodic lines are a pattern of the scene: bars have waves at multiples of a frequency."""

from __future__ import annotations

from core.physics.measurement.noise.periodic_lines import PeriodicLine

_MOST = 9  # times the frequency of the pattern
_TWO = 2  # lines of a pattern that is strong; weak ones may be two by chance
_BINS = 0.5  # of the spectrum, by which a multiple may be missed


def scene_pattern(
    *, lines: tuple[PeriodicLine, ...], sigma: float, shape: tuple[int, int]
) -> tuple[PeriodicLine, ...]:
    """Lines at whole multiples of one frequency: three, or two and the strongest above the noise.

    Parameters
    ----------
    lines
        Of the picture, the strongest first.
    sigma : float
        Noise of a sample.
    shape : tuple of int
        Rows and columns of the picture.

    Notes
    -----
    Bars and other repeated shapes of a scene have harmonics, folded where they pass half a cycle a
    sample; what electronics pick up is mostly one wave, or weak. The fundamental itself may be too
    low to be looked for.
    """
    if not lines:
        return ()
    best: tuple[PeriodicLine, ...] = ()
    for order in range(1, _MOST + 1):
        base = lines[0].across / order, lines[0].down / order
        family = tuple(line for line in lines if _is_multiple(line, base, order, shape))
        if len(family) > max(1, len(best)):
            best = family
    enough = _TWO if lines[0].amplitude > sigma else _TWO + 1
    return best if len(best) >= enough else ()


def _is_multiple(
    line: PeriodicLine, base: tuple[float, float], order: int, shape: tuple[int, int]
) -> bool:
    """Whether a line lies at a whole multiple of a frequency known by its `order`-th multiple."""
    rows, columns = shape
    for times in range(1, _MOST + 1):
        bins = _BINS * max(1.0, times / order)
        for sign in (1.0, -1.0):
            across = _folded(times * base[0] - sign * line.across)
            down = _folded(times * base[1] - sign * line.down)
            if abs(across) * columns <= bins and abs(down) * rows <= bins:
                return True
    return False


def _folded(frequency: float) -> float:
    """The frequency, −0.5 to 0.5 cycles per sample, that samples take it for."""
    return frequency - round(frequency)
