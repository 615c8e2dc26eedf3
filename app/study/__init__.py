"""Studies: a network evaluated at many points of its parameters and over many pictures."""
