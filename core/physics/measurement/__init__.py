"""MTF measured from edges in a picture."""
