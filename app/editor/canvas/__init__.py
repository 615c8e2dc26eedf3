"""The canvas: draws the document's network and turns every gesture into an operation on it."""
