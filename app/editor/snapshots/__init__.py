"""Snapshots: kept states of the network, compared with the present one in pictures and figures."""
