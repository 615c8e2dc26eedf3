"""Reading and writing of pictures, matrices and curves, with one clear error for each fault."""
