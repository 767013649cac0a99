"""What commands that make runs have in common: their arguments, and how they end."""

import argparse
import signal
import sys

# exit codes of `evodevo run`
NO_FITNESS = 3  # the run is complete, but no individual has a fitness
STOPPED = 130  # the run was asked to stop; it has finished its generation and can be resumed


class Failure(Exception):
    """The reason why a command cannot continue, with the remedy."""


class Interrupted(Exception):
    """The user has asked the command to stop."""


def positive(text):
    """Reads a whole number of at least 1."""
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{text}: expected a whole number of at least 1")
    return int(text)


def parser(name, description, epilog):
    """Returns a parser of the arguments of tools/NAME, whose texts keep their lines."""
    return argparse.ArgumentParser(
        f"tools/{name}",
        description=description,
        formatter_class=argparse.RawDescriptionHelpFormatter,
        epilog=epilog,
        allow_abbrev=False,
    )


def ended(name, act):
    """Calls `act`, tells the user why it ended early if it did, and returns the exit code of tools/NAME."""

    def interrupt(_signal, _frame):
        raise Interrupted

    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, interrupt)
    try:
        act()
    except Failure as failure:
        print(f"{name}: {failure}", file=sys.stderr)
        return 2
    except OSError as error:
        place = f"{error.filename}: " if error.filename else ""
        print(f"{name}: {place}{error.strerror or error}", file=sys.stderr)
        return 2
    except Interrupted:
        print(f"{name}: interrupted; the same command goes on", file=sys.stderr)
        return 130
    return 0
