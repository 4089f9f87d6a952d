# The paper, Section "Dynamic Scenarios", "Interrupts": nested try-interrupt statements.
model street

targetRegion = RectangularRegion((1.75, 20), 0, 7, 10)

behavior Drive():
    try:
        do FollowLaneBehavior()
    interrupt when self.distanceToNextObstacle() < 20:
        do PassingBehavior()

behavior DriveWithSuddenBrake():
    haveBraked = False
    try:
        do Drive()
    interrupt when self in targetRegion and not haveBraked:
        do StopBehavior() for 5 seconds
        haveBraked = True

ego = Car at (1.75, 0), with behavior DriveWithSuddenBrake
