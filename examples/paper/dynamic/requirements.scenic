# The paper, Section "Dynamic Scenarios", "Requirements and Monitors": `require always`, `require eventually`, `require` in a behavior.
model street

behavior WaitUntilClose(threshold=15):
    while (distance from self to ego) > threshold:
        require self.distanceToClosest(Pedestrian) > threshold
        wait
    do FollowLaneBehavior()

ego = Car at (1.75, Range(20, 40)), facing Range(-5, 5) deg, with behavior FollowLaneBehavior
carA = Car at (1.75, 80), with behavior FollowLaneBehavior
carB = Car at (-1.75, 70), with behavior WaitUntilClose
Pedestrian at (5, Range(40, 100))
require always not ((ego can see carA) and (ego can see carB) and (distance to carA) < 5)
require eventually ego in intersection
