"""The photograph: colours for what a view shows, so that telling the classes apart must be learned.

Each object has a colour of its own, and the colours of the classes overlap. Light, texture, distance, exposure and
the sensor change it further. One dial, `noise`, scales all that a clean drawing would not have.

    rgb = albedo * facing * distance * gradient * texture * exposure + sensor noise
"""

import numpy as np

from .classes import CEILING, FLOOR
from .strip import FIELD_OF_VIEW_RAD, FRONT, TOP, slopes

SUN_RAD = 0.8  # bearing from which the light comes, so that two sides of a box differ
EXPOSURE_STD, BALANCE_STD, GRADIENT_STD, SENSOR = 0.10, 0.04, 0.10, 0.10
# How much the texture of each class shows: wood and cloth much, paint and steel little.
GRAIN = np.array([.03, .10, .02, .05, .10, .12, .08, .01, .01, .08])


def photograph(world, poses, surfaces, size, height_m, rng, noise=1.0):
    """Colours of views, column by column: poses (B, 3) and what they show -> rgb (B, C, H, 3) uint8.

    Draws the same random numbers whatever there is to see.
    """
    B, H, f = len(poses), size, np.float32
    half = np.tan(FIELD_OF_VIEW_RAD / 2)
    elevation = (half * (1 - (2 * np.arange(H) + 1) / H)).astype(f)  # up / ahead of each row
    slope = slopes(H).astype(f)[:, None]

    table = surfaces.paint(_table(world, poses, surfaces, H, height_m), size)
    level, depth, grain, grain_ahead, grain_up, contrast, *albedo = (table[..., i] for i in range(9))
    depth = np.where(level == np.inf, depth, level / elevation).clip(0, 30)
    texture = np.sin(grain + depth * (grain_ahead + grain_up * elevation))

    exposure = np.exp(noise * EXPOSURE_STD * rng.standard_normal((B, 1))).astype(f)
    gain = exposure * np.exp(noise * BALANCE_STD * rng.standard_normal((B, 3))).astype(f)
    across, down = (noise * GRADIENT_STD * rng.standard_normal((2, B, 1, 1))).astype(f)
    light = (0.6 + 0.4 * np.exp(depth / f(-5))) * (1 + across * slope + down * elevation)
    light *= 1 + f(noise) * contrast * texture
    grit = rng.integers(2 ** 64, size=(3, -(-light.size // 8)), dtype=np.uint64).view(np.uint8)  # eight a draw

    rgb = np.empty((*light.shape, 3), np.uint8)
    for c in range(3):
        colour = albedo[c] * light * (255 * gain[:, c, None, None])
        colour += (grit[c, :light.size].reshape(light.shape) - f(127.5)) * f(noise * SENSOR)
        rgb[..., c] = colour.clip(0, 255)
    return rgb


def _table(world, poses, surfaces, size, height_m):
    """What the pixels of each surface share, (S, 9) float32.

    columns : height above the camera [m] of a level surface, inf for a front; depth of a front [m];
              phase of the texture at the camera, its change per metre of depth straight on and upwards; its contrast; albedo
    """
    view, column = np.divmod(surfaces.ray, size)
    x, y, theta = poses.T
    s, box, kind = slopes(size)[column], surfaces.box, surfaces.kind
    cos, sin = np.cos(theta)[view], np.sin(theta)[view]
    ahead_x, ahead_y = cos - sin * s, sin + cos * s

    # A ceiling is an underside at the height of the walls, a floor a top at none.
    z = np.vstack([world.z, [world.wall_height, world.wall_height], [0, 0]])[box]
    level = np.where(kind == FRONT, np.inf, np.where(kind == TOP, z[:, 1], z[:, 0]) - height_m)

    n = np.arange(len(world.label) + 2)
    turn, pitch = 2.4 * n, 12 + 9 * np.sin(1.7 * n)  # the golden angle: no two neighbours have the same grain
    gx, gy, gz = ((pitch * g)[box] for g in (np.cos(turn), np.sin(turn), np.sin(3.1 * n)))
    grain = gx * x[view] + gy * y[view] + box

    facing = np.choose(kind, [_facing(world, x[view] + ahead_x / surfaces.w, y[view] + ahead_y / surfaces.w, box),
                              0.95, 0.6])
    facing[box >= len(world.label)] = 0.95
    contrast = np.append(GRAIN[world.label], GRAIN[[CEILING, FLOOR]])[box]
    albedo = np.vstack([world.colour, world.ceiling_colour, world.floor_colour])[box] * facing[:, None]
    return np.column_stack([level, 1 / surfaces.w, grain, gx * ahead_x + gy * ahead_y, gz, contrast, albedo
                            ]).astype(np.float32)


def _facing(world, x, y, box):
    """Brightness of the side of each box on which the point (x, y) lies."""
    box = box.clip(None, len(world.label) - 1)
    dx, dy, angle = x - world.centre[box, 0], y - world.centre[box, 1], world.angle[box]
    u = (dx * np.cos(angle) + dy * np.sin(angle)) / world.half[box, 0]
    v = (dy * np.cos(angle) - dx * np.sin(angle)) / world.half[box, 1]
    # On a side one of the two coordinates is +-1 and the other is less.
    normal = angle + np.where(abs(u) > abs(v), np.where(u > 0, 0, np.pi), np.copysign(np.pi / 2, v))
    return 0.8 + 0.15 * np.cos(normal - SUN_RAD)
