"""python -m gnl: the command line of the graph neural localizer."""

import argparse

from . import ablate, demo, draw_graph, report, table
from .terminal import guarded


def main(argv=None):
    """Parse the command line and run the command."""
    parser = argparse.ArgumentParser(
        prog="python -m gnl",
        description="The graph neural localizer: where am I, and where should I look next? `make demo` shows it all.")
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    command = commands.add_parser("demo", help="learn every stage in a home and let a robot find out where it is")
    demo.add_arguments(command)
    command.set_defaults(run=demo.run)
    command = commands.add_parser("graph", help="print and draw the scene graph of a label image of your own")
    draw_graph.add_arguments(command)
    command.set_defaults(run=draw_graph.run)
    command = commands.add_parser("table", help="the paper's Table I: every gap, world and method")
    table.add_arguments(command)
    command.set_defaults(run=table.run)
    command = commands.add_parser("ablate", help="what the paper leaves open: the effect of other choices")
    ablate.add_arguments(command)
    command.set_defaults(run=ablate.run)
    command = commands.add_parser("report", help="the table as Markdown and pictures, with intervals")
    report.add_arguments(command)
    command.set_defaults(run=report.run)
    args = parser.parse_args(argv)
    guarded("python -m gnl", args.run, args)


if __name__ == "__main__":
    main()
