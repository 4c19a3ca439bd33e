"""The photograph: colours for what a view shows, so that telling the classes apart must be learned.

Each object has a colour of its own, and the colours of the classes overlap. Light, texture, distance, exposure and
the sensor change it further. One dial, `noise`, scales all that a clean drawing would not have.

    rgb = albedo * facing * distance * gradient * texture * exposure + sensor noise
"""

import numpy as np

from .classes import CEILING, FLOOR
from .strip import TOP, UNDERSIDE, slopes

MOST_NOISE = 10.0
SUN_RAD = 0.8  # bearing from which the light comes, so that two sides of a box differ
EXPOSURE_STD, BALANCE_STD, GRADIENT_STD, SENSOR = 0.10, 0.04, 0.10, 0.10
# How much the texture of each class shows: wood and cloth much, paint and steel little.
GRAIN = np.array([.03, .10, .02, .05, .10, .12, .08, .01, .01, .08])
FARTHEST_M = 30


def photograph(world, poses, surfaces, size, height_m, rng, noise=1.0):
    """Colours of views: poses (B, 3) and what they show -> rgb (B, H, C, 3) uint8.

    Draws the same random numbers whatever there is to see. Most of the time goes into passes over all pixels: so
    there are few, each works in place, and all that the pixels of a surface share is computed once for each surface.
    """
    B, H, f = len(poses), size, np.float32
    exposure = np.exp(noise * EXPOSURE_STD * rng.standard_normal((B, 1)))
    gain = 255 * exposure * np.exp(noise * BALANCE_STD * rng.standard_normal((B, 3)))
    across, down = (noise * GRADIENT_STD * rng.standard_normal((2, B, 1, 1))).astype(f)
    grit = rng.integers(2 ** 64, size=(3, -(-B * H * H // 8)), dtype=np.uint64).view(np.int8)  # eight a draw
    grit = grit[:, :B * H * H].reshape(3, B, H, H)

    near, near_up, phase, ahead, upward, contrast, *albedo = _table(world, poses, surfaces, gain, H, height_m)
    surface = surfaces.paint(np.arange(len(surfaces.ray)), H)  # of each pixel, (B, C, H)
    up = slopes(H).astype(f)  # up / ahead of each row
    left = up[:, None]  # left / ahead of each column

    depth = near_up.take(surface)
    depth *= up
    depth += near.take(surface)
    np.maximum(depth, f(1 / FARTHEST_M), out=depth)
    np.reciprocal(depth, out=depth)

    texture = upward.take(surface)
    texture *= up
    texture += ahead.take(surface)
    texture *= depth
    texture += phase.take(surface)
    np.sin(texture, out=texture)
    texture *= contrast.take(surface)
    texture *= f(noise)
    texture += 1

    light = depth
    light *= f(-1 / 5)
    np.exp(light, out=light)
    light *= f(0.4)
    light += f(0.6)
    light *= (1 + across * left) + down * up
    light *= texture

    rgb = np.empty((B, H, H, 3), np.uint8)
    for c in range(3):
        colour = albedo[c].take(surface)
        colour *= light
        colour += grit[c] * f(noise * SENSOR)
        np.clip(colour, 0, 255, out=colour)
        rgb[..., c] = colour.transpose(0, 2, 1)
    return rgb


def _table(world, poses, surfaces, gain, size, height_m):
    """What the pixels of each surface share, (9, S) float32.

    rows : inverse depth straight on and its change upwards [1/m]; phase of the texture at the camera, its change per
           metre of depth straight on and upwards; its contrast; colour in full light
    """
    view, column = np.divmod(surfaces.ray, size)
    x, y = poses[view, 0], poses[view, 1]
    s, box, face = slopes(size)[column], surfaces.box, surfaces.face
    cos, sin = np.cos(poses[:, 2])[view], np.sin(poses[:, 2])[view]

    # A ceiling is an underside at the height of the walls, a floor a top at none.
    low, high = np.vstack([world.z, [world.wall_height, world.wall_height], [0, 0]]).T - height_m
    level = np.where(face == TOP, high[box], low[box])
    near, near_up = np.where(face < TOP, [surfaces.w, np.zeros(len(box))], [np.zeros(len(box)), 1 / level])

    n = np.arange(len(world.label) + 2)
    turn, pitch = 2.4 * n, 12 + 9 * np.sin(1.7 * n)  # the golden angle: no two neighbours have the same grain
    gx, gy, gz = ((pitch * g)[box] for g in (np.cos(turn), np.sin(turn), np.sin(3.1 * n)))
    phase, ahead = gx * x + gy * y + box, gx * (cos - sin * s) + gy * (sin + cos * s)

    contrast = np.append(GRAIN[world.label], GRAIN[[CEILING, FLOOR]])[box]
    colours = np.vstack([world.colour, world.ceiling_colour, world.floor_colour]).T
    brightness = _brightness(world)[box, face]
    albedo = [colour[box] * brightness * gain[:, c][view] for c, colour in enumerate(colours)]
    return np.array([near, near_up, phase, ahead, gz, contrast, *albedo], np.float32)


def _brightness(world):
    """Brightness of each face of each box, (N + 2, 6); the last two boxes are the ceiling and the floor."""
    normal = world.angle[:, None] + np.arange(TOP) * (np.pi / 2)
    of_face = np.full((len(world.label) + 2, 6), 0.95)
    of_face[:-2, :TOP] = 0.8 + 0.15 * np.cos(normal - SUN_RAD)
    of_face[:-2, UNDERSIDE] = 0.6
    return of_face


def check_noise(noise, name="noise"):
    """ValueError for an appearance noise that cannot be."""
    if not 0 <= noise <= MOST_NOISE:
        raise ValueError(f"{name}: expected 0..{MOST_NOISE:g}, found {noise}")
