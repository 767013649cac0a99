"""What a campaign has tried and found, in a file of JSON lines that outlives its sittings."""

import dataclasses
import json

from common.command_line import Failure


@dataclasses.dataclass(frozen=True)
class Outcome:
    """What a part found when it tried one kind of case for some time."""

    part: str
    case: str  # such as the name of a target
    tried: int
    found: tuple[str, ...]  # the faults, each with the file that shows it
    seconds: float  # added up over what was tried at the same time
    covered: int | None = None  # number of edges of the program's control flow that were taken so far


def name_on_device(part, device):
    """Returns the name of a part that simulates on a device, so that what was tried on each is counted for itself."""
    return part if device == "cpu" else f"gpu-{part}"


class Record:
    """The outcomes in DIR/outcomes.jsonl."""

    def __init__(self, folder):
        self._file = folder / "outcomes.jsonl"
        folder.mkdir(parents=True, exist_ok=True)
        self.outcomes = list(self._read()) if self._file.exists() else []

    def add(self, outcome):
        with self._file.open("a") as file:
            file.write(json.dumps(dataclasses.asdict(outcome)) + "\n")
        self.outcomes.append(outcome)

    def of(self, part):
        return [each for each in self.outcomes if each.part == part]

    def _read(self):
        text = self._file.read_text()
        complete = text[: text.rfind("\n") + 1]
        if complete != text:  # a sitting was killed while it wrote the last line
            self._file.write_text(complete)
        for number, line in enumerate(complete.splitlines(), 1):
            try:
                fields = json.loads(line)
                yield Outcome(**{**fields, "found": tuple(fields["found"])})
            except (ValueError, TypeError, KeyError):
                raise Failure(f"{self._file}:{number}: this is no outcome; remove the line, or name another --out") from None
