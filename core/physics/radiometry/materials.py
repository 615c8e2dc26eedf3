"""Detector materials: cut-off, quantum efficiency and own noise, with the source of each number.

The values are typical published ones, not those of one device; a measured D* is typed in as
`manual` instead.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from types import MappingProxyType
from typing import Literal

from core.errors import ParameterError

MANUAL = "manual"
"""The choice of a D* typed in by hand, in every region."""


@dataclass(frozen=True)
class Material:
    """A photon detector: all photons up to the cut-off count alike, unless it is a Schottky one.

    `quantum_efficiency` holds up to `cut_off_um`; with `fowler_per_eV` it is the internal
    photoemission C1·(hν − ψ)²/hν with ψ = hc/`cut_off_um` instead. `noise_factor` is 2 for the
    shot noise of a junction and 4 for generation and recombination in a photoconductor.
    """

    name: str
    cut_off_um: float
    temperature_K: float
    noise_factor: Literal[2, 4]
    source: str
    quantum_efficiency: float = 0.0
    fowler_per_eV: float = 0.0
    resistance_area_ohm_cm2: float = inf
    dark_current_A_per_cm2: float = 0.0


SILICON = Material(
    name="Si",
    cut_off_um=1.107,
    quantum_efficiency=0.7,
    temperature_K=300.0,
    noise_factor=2,
    resistance_area_ohm_cm2=1e7,
    source="photodiode at room temperature: band gap 1.12 eV (Sze 1981); zero-bias resistance of"
    " about 1 GΩ for 1 mm² (makers' data sheets), D* about 1e13 at the peak",
)

INSB = Material(
    name="InSb",
    cut_off_um=5.5,
    quantum_efficiency=0.7,
    temperature_K=77.0,
    noise_factor=2,
    resistance_area_ohm_cm2=1e6,
    source="photovoltaic at 77 K (Rogalski 2011, Infrared Detectors, InSb photodiodes); EG&G"
    " Judson 1995: D* about 1e11 at 5 µm in a 60° field of view",
)

PTSI = Material(
    name="PtSi",
    cut_off_um=5.6,
    fowler_per_eV=0.25,
    temperature_K=77.0,
    noise_factor=2,
    dark_current_A_per_cm2=1e-9,
    source="Schottky barrier of 0.22 eV on p-type silicon; emission C1 (hν − ψ)²/hν (Fowler 1931),"
    " C1 0.2 to 0.4 per eV (Shepherd 1992); about 1% at 4 µm",
)

HGCDTE_MWIR = Material(
    name="HgCdTe",
    cut_off_um=5.1,
    quantum_efficiency=0.7,
    temperature_K=77.0,
    noise_factor=2,
    resistance_area_ohm_cm2=1e6,
    source="photovoltaic, Hg0.70Cd0.30Te at 77 K; cut-off from the band gap of Hansen, Schmit and"
    " Casselman 1982",
)

HGCDTE_LWIR = Material(
    name="HgCdTe",
    cut_off_um=12.5,
    quantum_efficiency=0.7,
    temperature_K=77.0,
    noise_factor=4,
    source="photoconductive, Hg0.79Cd0.21Te at 77 K; cut-off from the band gap of Hansen, Schmit"
    " and Casselman 1982; EG&G Judson 1995: D* about 4e10 in a 60° field of view",
)

SI_GA = Material(
    name="Si:Ga",
    cut_off_um=17.1,
    quantum_efficiency=0.3,
    temperature_K=20.0,
    noise_factor=4,
    source="extrinsic photoconductor: ionization energy 0.0725 eV, quantum efficiency 30% (Bratt"
    " 1977, Semiconductors and Semimetals 12)",
)

SI_AS = Material(
    name="Si:As",
    cut_off_um=23.1,
    quantum_efficiency=0.2,
    temperature_K=10.0,
    noise_factor=4,
    source="extrinsic photoconductor: ionization energy 0.0537 eV, quantum efficiency 20% (Bratt"
    " 1977, Semiconductors and Semimetals 12)",
)

MATERIALS_BY_REGION = MappingProxyType(
    {
        "VIS": (SILICON,),
        "MWIR": (INSB, PTSI, HGCDTE_MWIR),
        "LWIR": (HGCDTE_LWIR, SI_GA, SI_AS),
    }
)
"""Which materials serve which region (Tantalo 1996, fig. 4.42)."""


def find_material(*, region: str, material: str, cut_off_um: float | None = None) -> Material:
    """The material of a name in a wavelength region.

    A material the region does not have is looked for in the others: of several compositions the
    one with the shortest cut-off that reaches `cut_off_um`, else the longest.

    Raises
    ------
    ParameterError
        For an unknown region, and for a material that no region has.
    """
    if region not in MATERIALS_BY_REGION:
        raise ParameterError("region", region, f"must be one of {', '.join(MATERIALS_BY_REGION)}")
    choices = {choice.name: choice for choice in MATERIALS_BY_REGION[region]}
    if material in choices:
        return choices[material]
    everywhere = [choice for part in MATERIALS_BY_REGION.values() for choice in part]
    named = [choice for choice in everywhere if choice.name == material]
    if not named:
        names = ", ".join(dict.fromkeys([*(choice.name for choice in everywhere), MANUAL]))
        raise ParameterError("material", material, f"must be one of {names}")
    named.sort(key=lambda choice: choice.cut_off_um)
    reaching = [choice for choice in named if choice.cut_off_um >= (cut_off_um or 0.0)]
    return reaching[0] if reaching else named[-1]
