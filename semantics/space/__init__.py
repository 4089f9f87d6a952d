"""Geometry, vectors, fields, regions and distributions: equations over numbers, arrays and symbols alike."""
