"""Faults that can be planted in a C++ source, one at a time: an operator, a bound or a constant that is a little
different, or a call that is left out."""

import dataclasses
import re

TOKEN = re.compile(
    r"""
    (?P<prose>//[^\n]*|/\*.*?\*/|^[ \t]*\#(?:\\\n|[^\n])*)|
    (?P<text>R"(?P<mark>[^(]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*")|
    (?P<number>(?:\d|\.\d)(?:[eEpP][+-]|'?[\w.])*)|
    (?P<letter>'(?:\\.|[^'\\])+')|
    (?P<word>[A-Za-z_]\w*)|
    (?P<sign>::|->|<<=|>>=|<=>|<<|>>|[<>=!+*/%&|^-]=|&&|\|\||\+\+|--|\S)
    """,
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
OPERATORS = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "&&": "||", "||": "&&", "==": "!=", "!=": "=="}
BOUNDS = {"<": "<=", "<=": "<", ">": ">=", ">=": ">"}
NO_CALLS = {"return", "throw", "if", "for", "while", "switch", "catch", "sizeof", "decltype", "delete", "static_assert"}
ONLY_SPEED = {"reserve", "shrink_to_fit"}  # calls that change no result
KINDS = ("operator", "bound", "constant", "call")


@dataclasses.dataclass(frozen=True)
class Fault:
    kind: str  # one of KINDS
    begin: int  # the characters of the source that are replaced, and
    end: int
    new: str  # by what

    def in_text(self, text):
        return text[: self.begin] + self.new + text[self.end :]


def faults(text):
    """Returns all faults that can be planted in a source. Comments, texts, the preprocessor's lines, and what the
    compiler asserts stay as they are."""
    tokens = [token for token in TOKEN.finditer(text) if token.lastgroup != "prose"]
    found = []
    asserted = False
    for i, token in enumerate(tokens):
        asserted = (asserted and token.group() != ";") or token.group() == "static_assert"
        if not asserted:
            found += _sign(tokens, i, text) + _constant(tokens, i) + _call(tokens, i)
    return found


def _sign(tokens, i, text):
    # Without spaces around it, < is a bracket, and - and * have one operand; beside a text, + composes a message.
    token = tokens[i]
    sign = token.group()
    if not text[token.start() - 1].isspace() or not text[token.end() : token.end() + 1].isspace():
        return []
    if any(beside.lastgroup == "text" for beside in tokens[i - 1 : i + 2]):
        return []
    for kind, others in (("operator", OPERATORS), ("bound", BOUNDS)):
        if sign in others:
            return [Fault(kind, token.start(), token.end(), others[sign])]
    return []


def _constant(tokens, i):
    token = tokens[i]
    # how long something waits changes no result: std::chrono::seconds patience{30}
    waits = "chrono" in (before.group() for before in tokens[max(0, i - 5) : i])
    if token.lastgroup != "number" or waits:
        return []
    parts = re.fullmatch(r"(\d[\d']*|0[xX][\da-fA-F']+)([uUlLzZ]*)", token.group())
    if parts:
        return [Fault("constant", token.start(), token.end(), f"{int(parts[1].replace(chr(39), ''), 0) + 1}{parts[2]}")]
    parts = re.fullmatch(r"([\d.']+(?:[eE][+-]?\d+)?)([fFlL]?)", token.group())
    value = float(parts[1].replace("'", "")) if parts else 0.0
    return [Fault("constant", token.start(), token.end(), f"{value * 1.01!r}{parts[2]}")] if value else []


def _call(tokens, i):
    """Returns the fault that leaves out the statement that begins at a token, if that is a call and nothing else."""
    begins = i > 0 and tokens[i - 1].group() in (";", "{", "}", ")", "else")
    if not begins or tokens[i].lastgroup != "word" or tokens[i].group() in NO_CALLS:
        return []
    at, name = i, tokens[i].group()
    while at + 2 < len(tokens) and tokens[at + 1].group() in ("::", ".", "->") and tokens[at + 2].lastgroup == "word":
        at, name = at + 2, tokens[at + 2].group()
    if at + 1 >= len(tokens) or tokens[at + 1].group() != "(" or name in ONLY_SPEED:
        return []
    depth = 0
    for end in range(at + 1, len(tokens) - 1):
        depth += {"(": 1, ")": -1}.get(tokens[end].group(), 0)
        if depth == 0:
            is_statement = tokens[end + 1].group() == ";"
            return [Fault("call", tokens[i].start(), tokens[end + 1].end(), "{}")] if is_statement else []
    return []
