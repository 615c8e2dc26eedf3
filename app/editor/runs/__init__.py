"""Runs that go on in the background while one edits."""
