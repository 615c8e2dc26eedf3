"""Parameters of a chain, fitted to a picture that a camera has taken."""
