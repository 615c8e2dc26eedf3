"""What shows computed values: pictures, curves, tables and figures."""
