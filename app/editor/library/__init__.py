"""The library's modules, to be searched and chosen."""
