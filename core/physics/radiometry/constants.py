"""Physical constants, the exact values of the SI.

Source: CODATA 2018 recommended values (Tiesinga, Mohr, Newell, Taylor 2021); h, c, k and e are
exact by definition of the SI since 2019.
"""

from math import pi

PLANCK_J_S = 6.62607015e-34
SPEED_OF_LIGHT_M_S = 299792458.0
BOLTZMANN_J_K = 1.380649e-23
ELEMENTARY_CHARGE_C = 1.602176634e-19

FIRST_RADIATION_CONSTANT_W_M2_SR = 2.0 * PLANCK_J_S * SPEED_OF_LIGHT_M_S**2
"""c1L = 2 h c**2, of spectral radiance, W m2 sr-1."""

# written out because h * c / k in floating point is one unit in the last place off,
# which e^(-c2/(λT)) multiplies by its exponent
SECOND_RADIATION_CONSTANT_M_K = 0.014387768775039338021
"""c2 = h c / k, m K."""

SECOND_RADIATION_CONSTANT_UM_K = 14387.768775039338021
"""c2 in µm K."""

STEFAN_BOLTZMANN_W_M2_K4 = (
    2.0 * pi**5 * BOLTZMANN_J_K**4 / (15.0 * PLANCK_J_S**3 * SPEED_OF_LIGHT_M_S**2)
)
