"""The words of the command line, and how a command reports and stops."""
