"""Every action of the window: its menu, its keys, what it does."""
