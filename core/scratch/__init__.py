"""Arrays that lie on disk where memory is not to hold them."""
