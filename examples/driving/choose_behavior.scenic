# dialect: scenic-3
# A car that does one of two things, and then the other.
model scenic.domains.driving.model

behavior Slowly():
    precondition: True
    do FollowLaneBehavior(3) for 2 seconds

behavior Fast():
    precondition: True
    do FollowLaneBehavior(8) for 2 seconds

behavior Both():
    do shuffle Slowly(), Fast()
    while True:
        do choose {Slowly(): 1, Fast(): 2}

ego = new Car with behavior Both
