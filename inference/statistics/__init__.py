"""What "the same distribution" means: anytime-valid tests by betting, with their evidence and their power."""
