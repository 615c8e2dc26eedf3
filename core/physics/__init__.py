"""Physics as pure, keyword-only functions: arrays in and out, units in the names."""
