"""Files of a lens: its MTF and its wavefront, measured or computed elsewhere."""
