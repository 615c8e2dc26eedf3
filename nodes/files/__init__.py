"""Reading and writing of pictures, matrices and curves.

A fault of a file is a `FileError` that begins with its path, in one line; docstrings say so only
where there is more to it.
"""
