# The paper, Appendix "Gallery of Scenarios", "A Badly-Parked Car", in the syntax of Section 4.
model scenic.simulators.gta.model

ego = Car
spot = OrientedPoint on visible curb
badAngle = Uniform(1.0, -1.0) * Range(10, 20) deg
Car left of spot by 0.5, facing badAngle relative to roadDirection
