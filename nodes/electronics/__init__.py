"""Modules of detector noise, electronics and quantization."""
