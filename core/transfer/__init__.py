"""Factors of transfer functions, their products and error budget, and filters that apply them."""
