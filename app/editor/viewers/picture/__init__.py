"""The viewer of pictures: how one is shown, zoomed, compared, probed and saved."""
