# In Scenic 3, `offset by` gives the car the heading of ego unless another is specified; in the paper it only gives the position.
from gta import *
ego = new Car
car2 = new Car offset by Range(-10, 10) @ Range(20, 40), facing roadDirection, with viewAngle 30 deg
require car2 can see ego
