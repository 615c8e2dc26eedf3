"""Results of a run: pictures, read-outs and curves."""
