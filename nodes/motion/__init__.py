"""Modules of motion, within an exposure and from frame to frame."""
