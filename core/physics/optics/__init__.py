"""Transfer functions of exit pupils: annuli, spiders, wavefronts, sampled pupils."""
