"""What is planned in the place of the network: with nodes held back, or with smaller pictures."""
