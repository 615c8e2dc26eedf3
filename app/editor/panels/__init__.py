"""Control panels: each drawn from the declaration of its module."""
