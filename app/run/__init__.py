"""One evaluation of a network, and its output files."""
