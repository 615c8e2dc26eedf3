"""Recovery files: work that survives a crash."""
