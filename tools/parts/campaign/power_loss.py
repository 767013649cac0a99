"""What a disk may hold after a loss of power, by a record of what was written to it."""

import posixpath

SECTOR = 512  # bytes, which a disk writes as a whole or not at all
SHARES = (0, 0.1, 0.5, 0.9, 1)  # of what is not certain to be on the disk
CHANGES = ("write", "ftruncate", "fsync", "fdatasync", "open", "unlink", "rename", "mkdir")


class File:
    def __init__(self, kept=b""):
        self.kept = bytearray(kept)  # what is certainly on the disk
        self.pending = []  # what may be: writes as (offset, bytes), and new sizes as (size, None)

    def synchronise(self):
        for change in self.pending:
            apply(change, self.kept)
        self.pending = []


def apply(change, content):
    offset, data = change
    if data is None:
        del content[offset:]
        content.extend(bytes(offset - len(content)))
    else:
        content.extend(bytes(max(0, offset - len(content))))
        content[offset : offset + len(data)] = data


class Disk:
    """A folder on a disk that may write what a program has written in any order, in parts, or not at all, until the
    program synchronises the file. The entry of a file in its folder is only certain after the folder was
    synchronised."""

    def __init__(self, folder):
        """`folder`: what is on the disk at the beginning."""
        self._now = {"": None}  # files by their paths; None for folders
        for path in sorted(folder.rglob("*")):
            self._now["/" + str(path.relative_to(folder))] = File(path.read_bytes()) if path.is_file() else None
        self._kept = dict(self._now)  # the entries that are certainly on the disk
        self._entries = []  # those that may be: (path, file) for a new or replaced one, and old paths, which are gone

    def play(self, call):
        """Does what a recorded call did."""
        if call.name not in CHANGES or call.result < 0:
            return
        file = self._now.get(call.file)
        if call.name == "open":
            self._open(call.file, file, call.detail)
        elif call.name == "mkdir":
            self._enter([(call.file, None)])
        elif call.name == "unlink":
            self._enter([(call.file,)])
        elif call.name == "rename":
            self._enter([(call.detail, file), (call.file,)])
        elif call.name in ("fsync", "fdatasync"):
            self._synchronise(call.file)
        elif file:
            size_or_offset = int(call.detail)
            file.pending.append((size_or_offset, call.data if call.name == "write" else None))

    def _open(self, path, file, how):
        if how == "new":
            self._enter([(path, File())])
        elif how == "emptied" and file:
            file.pending.append((0, None))

    def _enter(self, changes):
        """Changes entries, all or none of which will be on the disk."""
        enter(changes, self._now)
        self._entries.append(changes)

    def _synchronise(self, path):
        if self._now.get(path):
            self._now[path].synchronise()
            return
        for changes in [each for each in self._entries if parent(each[0][0]) == path]:
            enter(changes, self._kept)
            self._entries.remove(changes)

    def after_loss(self, random):
        """Returns what may be left: the content of each file by its path, and None for each folder."""
        share = random.choice(SHARES)
        left = dict(self._kept)
        for changes in self._entries[: round(share * len(self._entries))]:  # file systems keep their order
            enter(changes, left)
        reached = {path: file for path, file in left.items() if all(folder in left for folder in folders_above(path))}
        return {path: file and surviving(file, share, random) for path, file in reached.items()}


def enter(changes, entries):
    for path, *file in changes:
        if file:
            entries[path] = file[0]
        else:
            entries.pop(path, None)


def parent(path):
    return posixpath.dirname(path).rstrip("/")


def folders_above(path):
    while path:
        path = parent(path)
        yield path


def surviving(file, share, random):
    content = bytearray(file.kept)
    for offset, data in file.pending:
        for change in [(offset, None)] if data is None else sectors(offset, data):
            if random.random() < share:
                apply(change, content)
    return bytes(content)


def sectors(offset, data):
    """Yields the parts of a write that lie in different sectors."""
    begin = 0
    while begin < len(data):
        end = min(len(data), begin + SECTOR - (offset + begin) % SECTOR)
        yield offset + begin, data[begin:end]
        begin = end
