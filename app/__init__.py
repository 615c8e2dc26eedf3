"""The command line and its reports; `imagechain`, the package, is above it."""
