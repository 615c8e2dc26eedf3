"""Networks and their files: reading, checking, migrating, saving, and their expressions."""
