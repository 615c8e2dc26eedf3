"""A fit as a page: its figures and its words."""
