"""Finds and renews the parts of pages that are generated. A part begins with one of these lines, and ends with
<!-- end -->:

<!-- evodevo ARGUMENTS -->   the output of a command
<!-- source FILE -->         a file of C++ source, named relative to the root, as a fenced block
<!-- helpers -->             the helper headers of the SDK: what they declare, and which built-in operators use it
"""

import re
import textwrap
from functools import cache
from typing import NamedTuple

from pages import ROOT, evodevo

PAGE_FOLDER = ROOT / "framework/sdk"
INCLUDE_FOLDERS = [ROOT / "framework/sdk/evodevo", ROOT / "kernels/include/evodevo"]
# the interfaces, which have pages of their own
INTERFACES = {"body.hpp", "channels.hpp", "devo.hpp", "encoding.hpp", "fitness.hpp", "genome.hpp", "operator.hpp",
              "parameters.hpp", "plugin.hpp", "rng.hpp", "samples.hpp", "selection.hpp", "variation.hpp"}

BEGIN = r"(?:template|inline|constexpr|class|struct|enum|using)\b"  # of a declaration outside of classes
# a docstring, and the declaration that follows it, up to its body
DOCUMENTED = re.compile(rf"((?:^///.*\n)+)(?:template <.*>\n)?({BEGIN}[^{{;]*[{{;](?:[\w, ]+}};)?)", re.M)


class Helper(NamedTuple):
    name: str
    text: str  # the first sentence of its docstring
    used_as: str  # a regular expression
    header: str  # file name


def name_of(declaration):
    """Returns the name that a C++ declaration declares."""
    declaration = re.sub(r"^template <[^>]*>\s*", "", declaration)
    for pattern in (r"\b(?:class|struct|enum|using) (\w+)", r"^[^(]*\b(\w+) = {", r"(\w+)\(", r"(\w+) = "):
        if found := re.search(pattern, declaration):
            return found[1]
    raise ValueError(f"no name: {declaration}")


def first_sentence(docstring):
    text = " ".join(line.removeprefix("///").strip() for line in docstring.splitlines())
    return re.split(r"(?<=\.) (?=[A-Z`])", text, maxsplit=1)[0]


def use_of(name, declaration):
    """Returns a regular expression for uses of a name, or of the values of an enumeration, but not of a member."""
    values = re.search(r"^enum .*\{([\w, ]+)\}", declaration)
    return rf"::(?:{values[1].strip().replace(', ', '|')})\b" if values else rf"(?<![\w.>]){name}\b"


def title_of(header):
    """Returns the comment with which a header begins, in lines as long as those of pages."""
    lines = re.match(r"(?://(?!/).*\n)+", header.read_text(encoding="utf-8"))[0].splitlines()
    return textwrap.fill(" ".join(line.removeprefix("//").strip() for line in lines), 120)


def helpers_in(header):
    """Returns what a header declares outside of classes, each name once."""
    text, found = header.read_text(encoding="utf-8"), {}
    space = re.search(r"^namespace evodevo::(\w+)", text, re.M)
    for docstring, declaration in DOCUMENTED.findall(text):
        name = name_of(declaration)
        full_name = f"{space[1]}::{name}" if space else name
        found.setdefault(name, Helper(full_name, first_sentence(docstring), use_of(name, declaration), header.name))
    return list(found.values())


def undocumented(text):
    """Returns the first lines of the declarations outside of classes that have no docstring."""
    before, found = "", []
    for line in text.splitlines():
        if re.match(BEGIN, line) and not before.startswith(("///", "template")):
            found.append(line)
        if not (line.startswith("template") and before.startswith("///")):
            before = line
    return found


def headers():
    """Returns all installed headers but the interfaces; those in the folder `helpers` come last."""
    found = [file for folder in INCLUDE_FOLDERS for file in folder.rglob("*.hpp") if file.name not in INTERFACES]
    return sorted(found, key=lambda file: ("helpers" in file.parts, file.name))


def without_comments(file):
    return re.sub(r"//.*", "", file.read_text(encoding="utf-8"))


@cache
def users():
    """Returns the source of everything that may use helpers, by name: of operators, and of the helper headers."""
    found = {}
    for file in sorted((ROOT / "plugins").rglob("*.cpp")):
        text = without_comments(file)
        for name in re.findall(r'operator_entry<\w+>\(\s*"([^"]+)"', text):
            found[name] = text
    found.update({file.name: without_comments(file) for file in headers()})
    return found


def users_of(helper):
    others = [f"`{user}`" for user, text in users().items()
              if user != helper.header and re.search(helper.used_as, text)]
    is_used_here = len(re.findall(helper.used_as, users()[helper.header])) > 1
    return ", ".join(others or ["this header"] if is_used_here else others)


def included_as(header):
    return "evodevo/" + str(next(header.relative_to(f) for f in INCLUDE_FOLDERS if header.is_relative_to(f)))


def link_to(header):
    if header.is_relative_to(PAGE_FOLDER):
        return str(header.relative_to(PAGE_FOLDER))
    return "../../" + str(header.relative_to(ROOT))


def section_on(header):
    lines = [f"### [`{included_as(header)}`]({link_to(header)})", "", title_of(header), "",
             "| name | what it is or does | used by |", "|---|---|---|"]
    lines += [f"| `{helper.name}` | {helper.text} | {users_of(helper)} |" for helper in helpers_in(header)]
    return "\n".join(lines) + "\n"


def list_of_helpers():
    return "\n".join(section_on(header) for header in headers())


PART = re.compile(r"(<!-- (evodevo|source|helpers)\b *([^>]*?) -->\n)(.*?)(<!-- end -->\n)", re.S)
WRITERS = {
    "evodevo": lambda arguments: evodevo(*arguments.split()).stdout,
    "source": lambda path: "```cpp\n" + (ROOT / path).read_text(encoding="utf-8") + "```\n",
    "helpers": lambda _: list_of_helpers(),
}


def without_parts(text):
    """Returns a text without what is generated."""
    return PART.sub("", text)


def renewed(text):
    return PART.sub(lambda part: part[1] + WRITERS[part[2]](part[3]) + part[5], text)
