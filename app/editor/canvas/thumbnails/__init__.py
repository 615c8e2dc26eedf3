"""Small pictures and curves of what comes out of the nodes, below them on the canvas."""
