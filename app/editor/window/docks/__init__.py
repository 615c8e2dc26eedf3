"""The docks of the window: where they stand, and the viewers in them."""
