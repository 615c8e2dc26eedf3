"""What illustrations need computed, and the answers ready to be drawn."""
