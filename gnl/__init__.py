"""gnl, the graph neural localizer: from a first-person view to a place, and on to the next view."""
