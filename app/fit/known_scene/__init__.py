"""How a picture of a known scene lies over the network's."""
