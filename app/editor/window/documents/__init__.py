"""Opening, saving, recovering and leaving documents, and the first page."""
