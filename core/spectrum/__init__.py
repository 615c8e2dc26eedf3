"""Pictures in bands of wavelength: weighted sums of them, filtered by laws of wavelength."""
