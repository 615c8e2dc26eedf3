"""Run time of whole networks, of edits, of growing pictures and of the window."""
