"""Trade-offs: figures of merit as a parameter moves."""
