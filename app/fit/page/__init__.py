"""A fit as a page, as JSON and as lines of text: its figures and its words."""
