"""How cameras and line scanners sample a scene."""
