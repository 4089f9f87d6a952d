# dialect: scenic-3
# A monitor rejects the runs in which ego becomes too fast.
model scenic.domains.driving.model

monitor SpeedLimit():
    while True:
        require ego.speed <= 12
        wait

ego = new Car with behavior FollowLaneBehavior(target_speed=Range(5, 9))
require monitor SpeedLimit()
record ego.speed as speed
terminate after 8 seconds
