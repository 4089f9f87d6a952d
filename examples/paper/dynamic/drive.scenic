# The paper, Section "Dynamic Scenarios", "Interrupts": a hierarchy of behaviors.
model street

behavior Drive():
    try:
        do FollowLaneBehavior()
    interrupt when self.distanceToNextObstacle() < 20:
        do PassingBehavior()
    interrupt when self.timeToCollision() < 1:
        do CollisionAvoidance()

ego = Car at (1.75, 0), with behavior Drive
Car at (1.75, 50)
