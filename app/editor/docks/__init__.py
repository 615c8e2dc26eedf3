"""Docks of the window: runs, snapshots, trade-off, measurement, fit."""
