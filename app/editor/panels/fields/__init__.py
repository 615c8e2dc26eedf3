"""Fields of a panel: one class for each kind of parameter."""
