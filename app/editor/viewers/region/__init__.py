"""A region drawn on a picture, and moved there."""
