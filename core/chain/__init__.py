"""What is on a wire, and how it becomes a picture, a curve or a spectrum."""
