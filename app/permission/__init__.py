"""Where a network may write and which computers it may read from."""
