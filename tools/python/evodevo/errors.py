"""The errors of this package."""


class ArchiveError(Exception):
    """A folder that is no run, a run in another format, or something that a run does not have."""


class ProgramError(Exception):
    """The program `evodevo` is missing, or it failed; then the message is the program's."""
