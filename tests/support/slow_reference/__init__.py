"""A second engine that only tests use: direct sums in extended precision, shared with nobody.

It imports neither `core` nor `nodes`. A network comes as plain data, every parameter filled in, and
what a module does is written down again from its formula. Pictures are matrices, transforms are
products with matrices of the Fourier kernel, mirrored frames are really mirrored.

Left out: whatever draws random numbers, files in place of pictures' arrays, figures and curves.
"""
