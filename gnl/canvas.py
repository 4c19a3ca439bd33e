"""A sheet to draw on; everything is drawn four times as large and then shrunk, so that lines are smooth.

    px   of the finished picture, (column, row), row 0 at the top
"""

import copy

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from .classes import PALETTE

PAPER, INK, QUIET, BAR, FAINT = (255, 255, 255), (38, 40, 46), (112, 116, 124), (158, 164, 174), (216, 219, 224)
ROBOT, BELIEF, RIGHT, WRONG = (213, 94, 0), (92, 60, 160), (0, 140, 100), (196, 30, 58)
TINTS = (250, 242, 226), (232, 243, 236), (234, 240, 249), (250, 236, 232), (242, 237, 248), (241, 243, 226)
SMOOTH, LINE_PX = 4, 19  # enlargement; from one line of text to the next


class Canvas:
    """One sheet; colours are RGB or RGBA."""

    def __init__(self, width, height):
        self.width, self.height = round(width), round(height)
        self.image = Image.new("RGB", (SMOOTH * self.width, SMOOTH * self.height), PAPER)
        self.pen = ImageDraw.Draw(self.image, "RGBA")  # what lies below shines through a translucent colour

    def polygon(self, points, fill=None, outline=None, width=1.0):
        self.pen.polygon(_enlarged(points), fill, outline, round(SMOOTH * width))

    def box(self, x0, y0, x1, y1, fill=None, outline=None, width=1.0):
        corners = [SMOOTH * x0, SMOOTH * y0, SMOOTH * x1 - 1, SMOOTH * y1 - 1]
        self.pen.rounded_rectangle(corners, 2 * SMOOTH, fill, outline, round(SMOOTH * width))

    def line(self, points, colour=INK, width=1.0):
        self.pen.line(_enlarged(points), colour, round(SMOOTH * width), "curve")

    def disc(self, middle, radius, fill, outline=None, width=1.0):
        self.pen.circle(_enlarged([middle])[0], SMOOTH * radius, fill, outline, round(SMOOTH * width))

    def arrow(self, middle, theta, length, colour=INK, rim=None):
        """A dart that points to the bearing theta, counter-clockwise from the right; a rim sets it off from others."""
        forward, aside = np.array([[1, -1, -0.6, -1], [0, 0.65, 0, -0.65]])[..., None] * length / 2
        ahead = np.array([np.cos(theta), -np.sin(theta)])
        self.polygon(middle + forward * ahead + aside * ahead[::-1] * [1, -1], colour, rim, 0.5)

    def dial(self, middle, theta, radius, colour):
        """A disc, and on it the bearing theta."""
        self.disc(middle, radius, colour, PAPER, 1.5)
        self.arrow(middle, theta, 1.4 * radius, PAPER)

    def text(self, at, words, size=12, colour=INK, anchor="lm", halo=None):
        self.pen.text(_enlarged([at])[0], words, colour, ImageFont.load_default(SMOOTH * size), anchor,
                      stroke_width=2 * SMOOTH if halo else 0, stroke_fill=halo)

    def paste(self, picture, x, y):
        large = picture.resize((SMOOTH * picture.width, SMOOTH * picture.height), Image.Resampling.NEAREST)
        self.image.paste(large, (SMOOTH * round(x), SMOOTH * round(y)))

    def picture(self):
        return self.image.reduce(SMOOTH)

    def copy(self):
        """The paper as it is now, to draw further on."""
        twin = copy.copy(self)
        twin.image = self.image.copy()
        twin.pen = ImageDraw.Draw(twin.image, "RGBA")
        return twin


def colour_of(label, alpha=255):
    """Colour of a class, RGBA."""
    return *PALETTE[label].tolist(), alpha


def text_width(words, size):
    """Width of a text as it is drawn [px]."""
    return ImageFont.load_default(SMOOTH * size).getlength(words) / SMOOTH


def _enlarged(points):
    """For Pillow, to which a whole number is the middle of a pixel, not its edge."""
    return [(SMOOTH * float(x) - 0.5, SMOOTH * float(y) - 0.5) for x, y in points]
