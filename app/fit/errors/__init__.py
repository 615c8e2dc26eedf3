"""Errors of a fit where its linearized model alone would be too sure."""
