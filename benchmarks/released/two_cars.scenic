from gta import *
wiggle = Range(-10 deg, 10 deg)
ego = new EgoCar with roadDeviation wiggle
new Car visible, with roadDeviation resample(wiggle)
new Car visible, with roadDeviation resample(wiggle)
