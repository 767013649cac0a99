"""What tests of commands in tools/ share: a folder for each test, programs that stand in for evodevo, and calls of a
command in this process, which take a second less than starting Python."""

import contextlib
import io
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.environ["EVODEVO_PROGRAM"]


def called(main, words, program=PROGRAM):
    """Calls the `main` of a command's module `command`, and returns how it ended and what it said."""
    words = [*map(str, words)]
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        try:
            code = main(words, str(program))
        except SystemExit as ended:  # of arguments that cannot be understood
            code = ended.code
    return subprocess.CompletedProcess(words, code, out.getvalue(), err.getvalue())


def stopped(module, words, number, seen=""):
    """Starts a command, sends it a signal once it has printed a line with `seen`, and returns its exit code and what it
    says then."""
    command = [sys.executable, "-P", "-m", module, *words]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        next(line for line in process.stdout if seen in line)
        process.send_signal(number)
        _, said = process.communicate()
    return process.returncode, said


class InOwnFolder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory())).resolve()

    def script(self, text, name="program"):
        """Returns a program, given its text."""
        file = self.folder / name
        file.write_text(text)
        file.chmod(0o755)
        return file

    def program(self, lines, program=PROGRAM):
        """Returns a program that executes lines of a shell script before it does what evodevo does."""
        return self.script(f'#!/bin/sh\n{lines}\nexec {shlex.quote(str(program))} "$@"\n')
