"""A network judged: an edge sent through it, its noise and blur, what its detector counts."""
