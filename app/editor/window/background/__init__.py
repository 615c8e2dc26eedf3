"""Reports and queued runs in the window."""
