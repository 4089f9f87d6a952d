# The paper, Section "Dynamic Scenarios", "Interrupts": a time limit.
model street

behavior DriveForAWhile():
    do FollowLaneBehavior() for 3 seconds
    do FollowLaneBehavior(2) for 20 steps

ego = Car at (1.75, 0), with behavior DriveForAWhile
