"""Filters, gain and bias, quantization and periodic noise."""
