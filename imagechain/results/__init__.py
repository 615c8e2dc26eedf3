"""What a run delivers: pictures, read-outs and curves."""
