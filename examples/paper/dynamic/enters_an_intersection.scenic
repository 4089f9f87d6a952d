# Section "Dynamic Scenarios", "Requirements and Monitors": `require eventually`.
model scenic.domains.driving.model

ego = Car on network.lanes[0].road, with behavior FollowLaneBehavior

require eventually ego in intersection
