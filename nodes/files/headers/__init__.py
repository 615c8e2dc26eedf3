"""Headers of ENVI and FITS files, and pictures described by them."""
