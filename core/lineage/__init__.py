"""What becomes of a picture in a step: its lineage, declared where the step is written."""
