"""How edges look on a picture, everywhere."""

from __future__ import annotations

USED, REFUSED, REMOVED = "#e69f00", "#56b4e9", "#f0e442"
"""Of edges in use, not in use, and removed by hand: Okabe and Ito's orange, sky blue and yellow,
which all kinds of sight tell apart, on grey too. The lines differ as well: full, dashed, dotted."""
