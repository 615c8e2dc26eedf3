"""What several of the folders beside use."""
