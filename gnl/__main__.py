"""python -m gnl: the command line of the graph neural localizer."""

from . import ablate, demo, draw_graph, report, table
from .terminal import Parser, guarded

COMMANDS = {
    "demo": (demo, "learn every stage in a home and let a robot find out where it is"),
    "graph": (draw_graph, "print and draw the scene graph of a label image of your own"),
    "table": (table, "the paper's Table I: every gap, world and method"),
    "report": (report, "the table as Markdown and pictures, with intervals"),
    "ablate": (ablate, "what the paper leaves open: the effect of other choices"),
}


def main(argv=None):
    """Parse the command line and run the command."""
    parser = Parser(
        prog="python -m gnl",
        description="The graph neural localizer: where am I, and where should I look next? `make demo` shows it all.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, (module, words) in COMMANDS.items():
        command = commands.add_parser(name, help=words)
        module.add_arguments(command)
        command.set_defaults(run=module.run)
    args = parser.parse_args(argv)
    guarded("python -m gnl", args.run, args)


if __name__ == "__main__":
    main()
