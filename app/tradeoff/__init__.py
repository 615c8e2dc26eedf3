"""Trade-offs: figures of merit as a parameter moves, and the value that gives a wanted figure."""
