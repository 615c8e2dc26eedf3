"""Modules of the optics: camera, pupils, blur, light over the field."""
