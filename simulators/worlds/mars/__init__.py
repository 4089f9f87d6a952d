"""The world of the robot motion planning example: `mars.scenic`."""
