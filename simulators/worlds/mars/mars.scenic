# The workspace and the objects of the robot motion planning example
# (the paper, Appendix "Gallery of Scenarios", Section "Robot Motion Planning with a Bottleneck"); metres.

workspace = Workspace(RectangularRegion((0, 0), 0, 5, 5))

class MarsObject:
    position: Point in workspace
    heading: Range(0, 360) deg

# A flag to drive to.
class Goal(MarsObject):
    width: 0.3
    length: 0.3
    heading: 0

class Rover(MarsObject):
    width: 0.5
    length: 0.7
    heading: 0

# A rock that the rover can climb over.
class BigRock(MarsObject):
    width: 0.17
    length: 0.17

class Rock(MarsObject):
    width: 0.10
    length: 0.10

# A pipe that the rover cannot climb over.
class Pipe(MarsObject):
    width: 0.2
    length: Range(0.5, 1.5)
