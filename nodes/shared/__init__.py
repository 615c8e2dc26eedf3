"""What declarations of modules share: ports, defaults from the context, factors, warnings."""
