"""Implementations under test: this one, and others behind a process that speaks the harness protocol."""
