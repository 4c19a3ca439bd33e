"""python -m data_gen: write homes, training views and start poses to files, for `python -m gnl` to learn from."""

from gnl.terminal import command_line

COMMANDS = {
    "home": ("data_gen.rooms", "draw a procedural home"),
    "views": ("data_gen.views", "render views to train the segmentation net on"),
    "starts": ("data_gen.starts", "draw homes, and start poses with a gap between training and tests"),
}


def main(argv=None):
    """Run a command."""
    command_line("python -m data_gen", __doc__.partition(": ")[2], COMMANDS, argv)


if __name__ == "__main__":
    main()
