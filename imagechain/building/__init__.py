"""Open, build and change chains."""
