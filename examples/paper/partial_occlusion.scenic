# The paper, Section "Training on Rare Events", Figure "A scenario where one car partially occludes another", as printed.
model scenic.simulators.gta.model

wiggle = Range(-10 deg, 10 deg)
ego = Car with roadDeviation wiggle
c = Car visible,
        with roadDeviation resample(wiggle)
leftRight = Uniform(1.0, -1.0) * Range(1.25, 2.75)
Car beyond c by (leftRight, Range(4, 10)),
    with roadDeviation resample(wiggle)
