"""Wires that follow from what is done: partners, what fits, nodes put in and taken out."""
