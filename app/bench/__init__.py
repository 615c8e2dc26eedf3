"""``imagechain bench``: run time against error, in units of a bare Fourier round trip."""
