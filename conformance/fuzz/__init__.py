"""Campaigns of invented programs against another implementation: invented, compared, shrunk, grouped by cause, reported."""
