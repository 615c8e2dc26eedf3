"""The main window: what holds the parts together, its actions, files, settings and first page."""
