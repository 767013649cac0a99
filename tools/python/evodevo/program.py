"""The program `evodevo`, which simulates robots again."""

import json
import os
import pathlib
import shutil
import subprocess

from .errors import ProgramError


def program():
    """Returns the path of the program: what the variable EVODEVO_PROGRAM says, `evodevo` in PATH, or, if this package
    lies in a checkout, its tools/evodevo, which builds the program at its first call. Raises ProgramError."""
    given = os.environ.get("EVODEVO_PROGRAM")
    if given:
        return given
    in_path = shutil.which("evodevo")
    if in_path:
        return in_path
    in_checkout = pathlib.Path(__file__).resolve().parents[2] / "evodevo"
    if in_checkout.is_file():
        return str(in_checkout)
    raise ProgramError("there is no program evodevo; put it into PATH, or its path into the variable EVODEVO_PROGRAM")


def output_of(*arguments):
    """Calls the program and returns what it prints on standard output. Raises ProgramError with its message if it
    fails."""
    command = [program(), *map(str, arguments)]
    try:
        done = subprocess.run(command, capture_output=True, text=True)
    except OSError as error:
        raise ProgramError(f"{command[0]}: {error.strerror}; put the path of evodevo into EVODEVO_PROGRAM") from error
    if done.returncode != 0:
        raise ProgramError(done.stderr.strip() or f"{' '.join(command)} ended with exit code {done.returncode}")
    return done.stdout


def json_of(*arguments):
    """Calls the program and returns the JSON that it prints."""
    return json.loads(output_of(*arguments))
