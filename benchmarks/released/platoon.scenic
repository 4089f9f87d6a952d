from gta import *
param time = Range(8, 20) * 60
ego = new Car with visibleDistance 60
c2 = new Car visible
platoon = createPlatoonAt(c2, 5, dist=Range(2, 8))
