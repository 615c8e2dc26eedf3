"""What is on a wire, with its bands, noise and lineage, and how it becomes a picture or a curve."""
