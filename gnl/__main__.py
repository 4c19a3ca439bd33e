"""python -m gnl: the command line of the graph neural localizer."""

from .terminal import command_line

COMMANDS = {
    "demo": ("gnl.demo", "learn every stage in a home and let a robot find out where it is"),
    "graph": ("gnl.draw_graph", "print and draw the scene graph of a label image of your own"),
    "table": ("gnl.table", "the paper's Table I: every gap, world and method"),
    "report": ("gnl.report", "the table as Markdown and pictures, with intervals"),
    "ablate": ("gnl.ablate", "what the paper leaves open: the effect of other choices"),
}


def main(argv=None):
    """Run a command."""
    command_line("python -m gnl", "The graph neural localizer: where am I, and where should I look next? `make demo` "
                                  "shows it all.", COMMANDS, argv)


if __name__ == "__main__":
    main()
