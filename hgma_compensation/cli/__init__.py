"""The command ``hgma``."""
