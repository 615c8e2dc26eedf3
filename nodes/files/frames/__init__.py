"""Files of many frames, written and read one frame at a time."""
