"""How time and memory are measured, and what on."""
