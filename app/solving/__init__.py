"""At which value of a parameter a read-out has a value."""
