"""Computing what the window shows, in a thread of its own."""
