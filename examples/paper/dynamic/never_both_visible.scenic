# Section "Dynamic Scenarios", "Requirements and Monitors": `require always`, while ego comes to an intersection at which two cars wait.
model scenic.domains.driving.model

inter = network.intersections[4]
lane = inter.incomingLanes[0]
ego = Car at lane.centerline.pointAlongBy(Range(40, 50)), with behavior FollowLaneBehavior
carA = Car at inter.incomingLanes[1].centerline.pointAlongBy(Range(60, 90))
carB = Car at inter.incomingLanes[3].centerline.pointAlongBy(Range(60, 90))

require always not ((ego can see carA) and (ego can see carB))
