from gta import *
ego = new Car
spot = new OrientedPoint on visible curb
badAngle = Uniform(1.0, -1.0) * Range(10, 20) deg
new Car left of spot by 0.5, facing badAngle relative to roadDirection
