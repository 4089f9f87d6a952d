# Two objects side by side, which are usually far enough apart: short enough to read its whole trace.

ego = Object at 0 @ Range(0, 2), facing 30 deg
other = Object left of ego by Range(1, 2)
require[0.8] (distance from ego to other) > 2.2
