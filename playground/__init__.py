"""The playground, `scenic-ref play`: a page on the loopback address that draws the scenes of a program while one types."""
