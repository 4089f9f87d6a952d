ego = Car
Car
