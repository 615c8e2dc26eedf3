"""What pictures say of the camera that took them: edges, levels and noise."""
