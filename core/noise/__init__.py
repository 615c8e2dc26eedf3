"""Random fields with seeds of their own, and the power of noise after a chain."""
