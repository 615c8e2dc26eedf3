"""One evaluation of a network, its output files, and where these may be written."""
