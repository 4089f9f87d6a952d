# The robot world of the gallery for Scenic 3.

workspace = Workspace(RectangularRegion((0, 0), 0, 5, 5))

class MarsObject:
    position: new Point in workspace
    heading: Range(0, 360) deg

class Goal(MarsObject):
    width: 0.3
    length: 0.3

class Rover(MarsObject):
    width: 0.5
    length: 0.7
    heading: 0

class BigRock(MarsObject):
    width: 0.17
    length: 0.17

class Rock(MarsObject):
    width: 0.10
    length: 0.10

class Pipe(MarsObject):
    width: 0.2
    length: Range(0.5, 1.5)
