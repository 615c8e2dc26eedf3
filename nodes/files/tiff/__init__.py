"""Tagged image files read without OpenImageIO, strip by strip."""
