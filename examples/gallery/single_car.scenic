wiggle = Range(-10, 10) deg
ego = EgoCar with roadDeviation wiggle
Car visible, with roadDeviation resample(wiggle)
