"""Tests that every command in every `sh` block of every page exists and has the options used. Commands that take little
time are run."""

import re
import shlex
import shutil
import subprocess
import tempfile
import unittest
from functools import cache
from pathlib import Path
from typing import NamedTuple

from pages import PROGRAM, ROOT, SHRINK, PageTest, all_pages, blocks, evodevo, make_small_run, name

# programs of other projects, whose options are not checked
OTHERS = {"apt-get", "cd", "clang-format", "cmake", "cp", "ctest", "echo", "export", "g++", "gdb", "git", "man",
          "mkdir", "ninja", "pip", "python3", "sbatch", "sed", "source", "sqlite3", "sudo", "tar"}
# programs that start several processes of evodevo
LAUNCHERS = {"mpirun", "srun"}
# programs whose options go to another program, or that have none
WITHOUT_HELP = {"tools/test": "hands its options to CTest", "tools/setup": "is read by the other tools"}

# commands that are not run here, with the reason
NOT_RUN = {
    "conform": "takes a library; OutsidePlugin and Pages.examples run it",
    "environments": "takes minutes; EnvironmentsCommand tests it",
    "film": "takes a browser; the tests of the viewer run it",
    "gallery": "takes a built viewer; the tests of the viewer run it",
    "new": "writes a project; OutsidePlugin and ReadmeTutorial build it",
    "report": "takes a built viewer; the tests of the viewer run it",
}
OWN_PROJECT = ("experiment.toml", "walk.toml", "walk-1", "my-lab.growth")  # see ReadmeTutorial


class Command(NamedTuple):
    page: Path
    line: int
    words: list  # without redirections
    output: str | None  # the file to which its output is redirected

    def __str__(self):
        return f"{name(self.page)}:{self.line}: {' '.join(self.words)}"

    @property
    def program(self):
        word = self.words[0]
        return "evodevo" if word in ("tools/evodevo", "evodevo") or word.endswith("/bin/evodevo") else word

    @property
    def options(self):
        return [word.split("=")[0] for word in self.words if word.startswith("--") and word != "--"]


def commands_in(line):
    """Splits a shell command line into simple commands, as (words, output)."""
    lexer = shlex.shlex(line, posix=True, punctuation_chars=True)
    lexer.whitespace_split = True
    lexer.commenters = "#"
    found, words, output = [], [], None
    tokens = [*lexer, ";"]
    while tokens:
        token = tokens.pop(0)
        if token in (";", "&&", "||", "|"):
            if words:
                found.append((words, output))
            words, output = [], None
        elif token in (">", ">>"):
            output = tokens.pop(0)
        elif words or not re.fullmatch(r"[A-Z_]+=.*", token):
            words.append(token)
            if words[0] in LAUNCHERS and (token == "evodevo" or token.endswith("/evodevo")):
                words = [token]
    return found


def commands_of(page):
    for block in blocks(page, "sh"):
        text, line = block.text.replace("\\\n", " \0"), block.line  # "\0" keeps the count of lines
        for row in text.splitlines():
            for words, output in commands_in(row.replace("\0", "")):
                yield Command(page, line, words, output)
            line += 1 + row.count("\0")


@cache
def help_of(program, command=None):
    """Returns the help of a program, or None if the program fails."""
    call = [PROGRAM, command, "--help"] if program == "evodevo" else [str(ROOT / program), "--help"]
    finished = subprocess.run(call, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    return finished.stdout if finished.returncode == 0 else None


def missing_files(command):
    """Yields the files of the source tree that a command names and that do not exist. {a,b} and * are expanded as in a
    shell."""
    for word in command.words:
        if not re.match(r"(tools/[\w/]+|(experiments|framework|kernels|plugins|tests)/.*\.\w+)$", word):
            continue
        choice = re.search(r"\{([^}]*)\}", word)
        names = [word.replace(choice[0], one) for one in choice[1].split(",")] if choice else [word]
        yield from (one for one in names if not any(ROOT.glob(one)))


def fault_of(command):
    if missing := list(missing_files(command)):
        return f"{command}: there is no {', '.join(missing)}"
    program = command.program
    if program == "evodevo":
        if len(command.words) < 2 or command.words[1] in ("help", "--version", "--help"):
            return None
        text = help_of(program, command.words[1])
    elif program.startswith("tools/"):
        if program in WITHOUT_HELP:
            return None
        text = help_of(program) if command.options else ""
    else:
        return None if program in OTHERS else f"{command}: {program} is no program that pages use"
    if text is None:
        return f"{command}: {program} knows no such command"
    unknown = [option for option in command.options if not re.search(rf"{option}\b(?!-)", text)]
    return f"{command}: has no {', '.join(unknown)}" if unknown else None


def runnable(command):
    """Returns the words to run for a command, in a folder with a small run, or None if it is not run."""
    if command.program != "evodevo" or len(command.words) < 2 or command.words[1] in NOT_RUN:
        return None
    if any(own in word for own in OWN_PROJECT for word in command.words):
        return None
    words = command.words[1:]
    if words[0] == "run":
        if "experiments/quickstart.toml" in words:
            return words + SHRINK
        return ["check", *(word for word in words[1:] if word.endswith(".toml"))]  # other experiments take hours
    return [re.sub(r"^531$", "1", word) for word in words]  # 531 is an individual of a long run


class Commands(PageTest):
    def test_of_all_pages_exist(self):
        found = [command for page in all_pages() for command in commands_of(page)]
        self.assertGreater(len(found), 30)
        self.assert_none([fault for command in found if (fault := fault_of(command))])

    def test_that_are_wrong_are_found(self):
        for line in ("tools/evodevo rnu FILE.toml", "evodevo show DIR --jsno", "tools/nothing", "evodveo show DIR",
                     "evodevo check experiments/{evo,ove}.toml"):
            (words, output), = commands_in(line)
            self.assertIsNotNone(fault_of(Command(ROOT / "README.md", 1, words, output)), line)

    def test_lines_are_taken_apart(self):
        self.assertEqual(commands_in("A=1 one --x 'a b' > out.json && two | three  # four"),
                         [(["one", "--x", "a b"], "out.json"), (["two"], None), (["three"], None)])

    def test_that_are_cheap_do_what_they_say(self):
        count, faults = 0, []
        with tempfile.TemporaryDirectory() as scratch:
            make_small_run(Path(scratch, "small"))
            for page in all_pages():
                folder = Path(scratch, str(count))
                shutil.copytree(Path(scratch, "small"), folder / "runs/quickstart-1")
                (folder / "experiments").symlink_to(ROOT / "experiments")
                for command in commands_of(page):
                    if (words := runnable(command)) is None:
                        continue
                    count += 1
                    finished = evodevo(*words, folder=folder, check=False)
                    if finished.returncode != 0:
                        faults.append(f"{command}: ended with {finished.returncode}: {finished.stderr}")
                    elif command.output:
                        Path(folder, command.output).write_text(finished.stdout, encoding="utf-8")
                shutil.rmtree(folder)
        self.assert_none(faults)
        self.assertGreater(count, 10)


unittest.main()
