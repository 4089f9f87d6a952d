# Colors of the released library: triples of reals in [0, 1].

from scenic.simulators.utils.rgb import RGB, COLOR_WEIGHTS

class Colors(object):
    def __call__(self, r, g, b):
        return RGB(r, g, b)

    # From bytes, and to bytes.
    def withBytes(self, color):
        return RGB(*[part / 255 for part in color])

    def realToByte(self, color):
        return tuple([round(part * 255) for part in color])

    def uniformColor(self):
        return RGB(Range(0, 1), Range(0, 1), Range(0, 1))

    # One of nine colors, by how popular they are for cars.
    def defaultCarColor(self):
        red, green, blue = Discrete(COLOR_WEIGHTS)
        return RGB(red, green, blue)

Color = Colors()
