"""The view of the canvas and what floats on it: lists, titles being typed, the map."""
