"""Networks that come with the program."""
