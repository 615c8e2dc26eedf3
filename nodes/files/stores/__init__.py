"""Pictures in stores: folders of chunks, of which any part is read and written by itself."""
