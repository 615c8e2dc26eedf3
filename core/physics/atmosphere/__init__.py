"""Transfer functions of scattering and turbulence."""
