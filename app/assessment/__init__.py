"""A network's final picture judged: an edge sent through it, and its budget of noise and blur."""
