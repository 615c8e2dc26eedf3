"""The trade-off dock: figures of merit as a parameter moves, live."""
