"""The command `crackfront`, which is `python -m crackfront`, from its first import on."""

import sys


def main() -> None:
    """Run the command line of the process; Ctrl-C ends it in a sentence while it is imported."""
    try:
        from crackfront.cli import main as commands
    except KeyboardInterrupt:
        sys.stderr.write("Interrupted before anything was computed; run the same command again\n")
        sys.exit(75)
    commands()


if __name__ == "__main__":
    main()
