"""Time against error for every choice that trades one for the other."""
