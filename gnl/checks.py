"""Checks of arguments, alike everywhere: a ValueError names the argument, what was expected and what was found."""

import numpy as np


def check_count(name, value, least, most=np.inf):
    """A whole number from least to most as an int, or a ValueError."""
    if not isinstance(value, int | np.integer) or not least <= value <= most:
        bounds = f"from {least} on" if most == np.inf else f"from {least} to {most}"
        raise ValueError(f"{name}: expected a whole number {bounds}, found {value!r}")
    return int(value)


def check_finite(name, values):
    """ValueError with the first of the values (...) that is NaN or infinite, if there is one."""
    if not np.isfinite(values).all():
        raise ValueError(f"{name}: expected finite numbers, found {values[~np.isfinite(values)][0]}")
