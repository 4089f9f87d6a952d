"""Blocks of scenes for processes and clusters, and their lines and tables."""
