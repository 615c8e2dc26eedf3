"""How a network is drawn, as its file has it: backdrops, dots of wires, and laying both out."""
