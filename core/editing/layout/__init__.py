"""Where nodes and backdrops stand."""
