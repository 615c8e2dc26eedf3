"""The files a benchmark writes: tables as pages and pictures."""
