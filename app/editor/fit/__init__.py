"""The dock that fits free parameters of the network to a picture."""
