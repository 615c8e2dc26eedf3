"""Ridges of a picture's gradient, and their straight pieces."""
