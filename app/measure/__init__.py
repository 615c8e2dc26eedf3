"""Measuring real pictures: edges, MTF and noise of picture files, as figures, files and a page."""
