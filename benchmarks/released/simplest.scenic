from gta import *
ego = new Car
new Car
