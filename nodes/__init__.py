"""The module library: declarations over core, test scenes and file formats."""
