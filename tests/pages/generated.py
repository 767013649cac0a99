"""Finds and renews the parts of pages that are generated. A part begins with one of these lines, and ends with
<!-- end -->:

<!-- evodevo ARGUMENTS -->   the output of a command
<!-- source FILE -->         a file of C++ source, named relative to the root, as a fenced block
<!-- helpers -->             the helper headers of the SDK: what they declare, and which built-in operators use it
"""

import re

from helpers import list_of_helpers
from pages import ROOT, evodevo

PART = re.compile(r"(<!-- (evodevo|source|helpers)\b *([^>]*?) -->\n)(.*?)(<!-- end -->\n)", re.S)


def quoted(path):
    return "```cpp\n" + (ROOT / path).read_text(encoding="utf-8") + "```\n"


WRITERS = {
    "evodevo": lambda arguments: evodevo(*arguments.split()).stdout,
    "source": quoted,
    "helpers": lambda _: list_of_helpers(),
}


def parts(text):
    return PART.findall(text)


def without_parts(text):
    """Returns a text without what is generated."""
    return PART.sub("", text)


def renewed(text):
    return PART.sub(lambda part: part[1] + WRITERS[part[2]](part[3]) + part[5], text)
