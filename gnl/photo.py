"""The photograph: colours for what a view shows, so that telling the classes apart must be learned.

Each object has a colour of its own, and the colours of the classes overlap. Light, texture, distance, exposure and
the sensor change it further. One dial, `noise`, scales all that a clean drawing would not have.

    rgb = albedo * facing * exposure * distance * gradient * texture + sensor

    albedo    the object's own colour                      facing    of a face: brighter towards the light
    exposure  of the view, and of each colour channel      distance  0.6 + 0.4 exp(-depth / 5 m)
    gradient  of the light across the view                 texture   1 + contrast * sin(waves on the surface)
    sensor    noise of each pixel and colour
"""

import numpy as np

from .classes import CEILING, FLOOR
from .strip import FACES, TOP, UNDERSIDE, slopes

MOST_NOISE = 10.0
SUN_RAD = 0.8  # bearing from which the light comes, so that two sides of a box differ
EXPOSURE_STD, BALANCE_STD, GRADIENT_STD = 0.10, 0.04, 0.10
SENSOR = 0.10  # times a uniform byte, -128..127: at most 13 of 255
# How much the texture of each class shows: wood and cloth much, paint and steel little.
GRAIN = np.array([.03, .10, .02, .05, .10, .12, .08, .01, .01, .08])
FARTHEST_M = 30


def photograph(world, poses, surfaces, size, height_m, rng, noise, wanted):
    """Colours of views: poses (B, 3) and what they show -> rgb (B, H, C, 3) uint8.

    wanted : (n,) bool, which of n views these B are: they get the luck that they have among all n

    Most of the time goes into passes over all pixels: so there are few, each works in place, and all that the pixels
    of a run share is computed once for each run.
    """
    B, H, f = len(poses), size, np.float32
    exposure, across, down, grit = (of_all[wanted] for of_all in _luck(len(wanted), H, rng, noise))

    near, near_up, phase, ahead, upward, contrast, *colours = _of_runs(world, poses, surfaces, exposure, H, height_m)
    up = slopes(H).astype(f)  # up / ahead of each row
    left = up[:, None]  # left / ahead of each column

    def pixels(of_run):  # (B, C, H)
        return np.repeat(of_run, surfaces.run_length).reshape(B, H, H)

    # depth = 1 / (near + near_up * up), FARTHEST_M at most
    depth = pixels(near_up)
    depth *= up
    depth += pixels(near)
    np.maximum(depth, f(1 / FARTHEST_M), out=depth)
    np.reciprocal(depth, out=depth)

    # texture = 1 + noise * contrast * sin(phase + depth * (ahead + upward * up))
    texture = pixels(upward)
    texture *= up
    texture += pixels(ahead)
    texture *= depth
    texture += pixels(phase)
    np.sin(texture, out=texture)
    texture *= pixels(contrast * f(noise))
    texture += 1

    # distance = 0.6 + 0.4 * exp(-depth / 5)
    distance = np.multiply(depth, f(-1 / 5), out=depth)
    np.exp(distance, out=distance)
    distance *= f(0.4)
    distance += f(0.6)

    gradient = (1 + across * left) + down * up
    light = np.multiply(distance, gradient, out=distance)
    light *= texture

    rgb = np.empty((B, H, H, 3), np.uint8)
    for c in range(3):
        colour = pixels(colours[c])  # albedo * facing * exposure
        colour *= light  # * distance * gradient * texture
        colour += grit[:, c] * f(noise * SENSOR)  # + sensor
        np.clip(colour, 0, 255, out=colour)
        rgb[..., c] = colour.astype(np.uint8).transpose(0, 2, 1)
    return rgb


def _luck(n_views, size, rng, noise):
    """The random part of n views: exposure (n, 3), gradient across and down (n, 1, 1) each, grit (n, 3, H, H) int8.

    Light and exposure are drawn before the pixels: the same number of views in another size get the same.
    """
    n, pixels = n_views, n_views * size * size
    # Albedo is in 0..1, a pixel in 0..255.
    exposure = 255 * np.exp(noise * EXPOSURE_STD * rng.standard_normal((n, 1)))
    exposure = exposure * np.exp(noise * BALANCE_STD * rng.standard_normal((n, 3)))
    across, down = (noise * GRADIENT_STD * rng.standard_normal((2, n, 1, 1))).astype(np.float32)
    grit = rng.integers(2 ** 64, size=(3, -(-pixels // 8)), dtype=np.uint64).view(np.int8)  # eight per draw
    return exposure, across, down, grit[:, :pixels].reshape(3, n, size, size).swapaxes(0, 1)


def _of_runs(world, poses, surfaces, exposure, size, height_m):
    """What the pixels of each run share, (9, R) float32.

    rows : inverse depth straight ahead and its change upwards [1/m]; phase of the texture at the camera, its change per
           metre of depth straight ahead and upwards; its contrast; colour in full light
    """
    N, C = len(world.label) + 2, size  # boxes with the ceiling, an underside, and the floor, a top
    of_run = np.empty((9, len(surfaces.run_ray)), np.float32)
    near, near_up, phase, ahead, upward, contrast = of_run[:6]
    face = surfaces.face.take(surfaces.run_surface)
    box, view = face // FACES, surfaces.run_ray // C

    near[:] = surfaces.w.take(surfaces.run_surface)
    levels = np.full((N, FACES), np.inf)  # heights of flat faces; a side has one inverse depth in all rows
    levels[:-2, UNDERSIDE], levels[:-2, TOP] = world.z.T - height_m
    levels[-2, UNDERSIDE], levels[-1, TOP] = world.wall_height - height_m, -height_m
    levels[levels == 0] = np.inf  # seen edge on, so not at all
    near_up[:] = (1 / levels).take(face)

    # The texture of a box: waves along a direction of its own, by the golden angle, so no two neighbours are alike.
    n = np.arange(N)
    turn, pitch = 2.4 * n, 12 + 9 * np.sin(1.7 * n)
    wave = pitch * [np.cos(turn), np.sin(turn)]  # along x and y
    (x, y, theta), which = poses.T, view * N + box
    cos, sin = np.cos(theta), np.sin(theta)
    phase[:] = (np.stack([x, y], 1) @ wave + n).take(which)
    ahead[:] = (np.stack([-sin, cos], 1) @ wave).take(which)
    ahead *= slopes(C).astype(np.float32).take(surfaces.run_ray - view * C)
    ahead += (np.stack([cos, sin], 1) @ wave).take(which)
    upward[:] = (pitch * np.sin(3.1 * n)).take(box)
    contrast[:] = np.append(GRAIN[world.label], GRAIN[[CEILING, FLOOR]]).take(box)

    albedo, facing = np.vstack([world.colour, world.ceiling_colour, world.floor_colour]), _facing(world)
    for c, colour in enumerate(of_run[6:]):
        colour[:] = (albedo[:, c, None] * facing).take(face) * exposure[:, c].take(view)
    return of_run


def _facing(world):
    """Brightness of each face of each box, (N + 2, 6); the last two boxes are the ceiling and the floor."""
    normal = world.angle[:, None] + np.arange(TOP) * (np.pi / 2)
    of_face = np.full((len(world.label) + 2, FACES), 0.95)
    of_face[:-2, :TOP] = 0.8 + 0.15 * np.cos(normal - SUN_RAD)
    of_face[:-2, UNDERSIDE] = 0.6
    return of_face


def check_noise(noise, name="noise"):
    """ValueError for an appearance noise out of range."""
    if not 0 <= noise <= MOST_NOISE:
        raise ValueError(f"{name}: expected 0..{MOST_NOISE:g}, found {noise}")
