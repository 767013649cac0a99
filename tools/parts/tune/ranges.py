"""The ranges of the keys that are tuned: their syntax, and values drawn from them.

A value is a text in TOML, or None if it is not in the range or not known."""

import dataclasses
import json
import math
import re
import tomllib

from common.command_line import Failure
from compare.runs import split_values

# Keys that would give runs of unequal cost, or scores that mean different things
REFUSED = {
    "experiment.evaluations": "all runs of a race have the same cost; give it with --set",
    "experiment.spring_evaluations": "all runs of a race have the same cost; give it with --set",
    "experiment.hours": "all runs of a race have the same cost, which the clock does not tell; leave it out",
    "experiment.seed": "a race gives every configuration the same seeds; leave it out",
    "experiment.lives": "it decides what a score is worth; give it with --set",
    "experiment.birth_noise": "it decides what a score is worth; give it with --set",
    "selection.remeasure": "it decides what a score is worth; give it with --set",
    "experiment.verify": "it decides which scores count; give it with --set",
    "experiment.verify_front": "it decides which scores count; give it with --set",
}
NUMBER = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d+)?")
WHOLE = re.compile(r"[+-]?\d+")


def toml_value(text):
    """Returns the value of a text in TOML, or None if the text is not one value."""
    try:
        parsed = tomllib.loads(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return None
    return parsed["value"] if list(parsed) == ["value"] else None


def same(one, other):
    """Returns whether two values of TOML are equal and of the same type: true is not 1."""
    return type(one) is type(other) and one == other


@dataclasses.dataclass(frozen=True)
class Numbers:
    """Numbers from `low` to `high`. Real ones are rounded: to two significant digits if they are drawn by their
    logarithm, and otherwise to the power of ten that divides the range into 50 to 500 steps. With finer values, few
    durations would be whole numbers of time steps."""

    key: str
    low: float
    high: float
    log: bool
    whole: bool

    def _place(self, value):
        low, high = self._ends()
        return ((math.log(value) if self.log else value) - low) / (high - low)

    def _ends(self):
        if self.log:
            return math.log(self.low), math.log(self.high)
        # every whole number has the same room
        return (self.low - 0.5, self.high + 0.5) if self.whole else (self.low, self.high)

    def _value(self, place):
        low, high = self._ends()
        value = low + (high - low) * place
        value = math.exp(value) if self.log else value
        if self.whole:
            return str(min(max(round(value), self.low), self.high))
        if self.log:
            value = float(f"{value:.1e}")
        else:
            value = round(value, -math.floor(math.log10((self.high - self.low) / 50)))
        return repr(min(max(value, self.low), self.high))

    def draw(self, random):
        return self._value(random.random())

    def draw_near(self, parent, random, spread, _weight):
        """Draws from a normal distribution around `parent` that is cut off at the ends of the range. `spread` is its
        standard deviation relative to the width of the range."""
        middle = self._place(float(parent))
        while not 0 <= (place := random.normal(middle, spread)) <= 1:
            pass
        return self._value(place)

    def find(self, value):
        """Returns the text of a value of the experiment."""
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        return repr(value) if is_number and self.low <= value <= self.high else None


@dataclasses.dataclass(frozen=True)
class Categories:
    key: str
    values: tuple

    def draw(self, random):
        return self.values[random.integers(len(self.values))]

    def draw_near(self, parent, random, _spread, weight):
        """Returns `parent` with probability `weight`, and otherwise any value."""
        return parent if random.random() < weight else self.draw(random)

    def find(self, value):
        return next((text for text in self.values if same(toml_value(text), value)), None)


def parse_range(text):
    """Parses `KEY=LOW..HIGH`, `KEY=LOW..HIGH:log` or `KEY=VALUE,VALUE,…`."""
    key, _, values = text.partition("=")
    if not key or not values or not all(key.split(".")):
        raise Failure(f"--over {text}: expected KEY=LOW..HIGH, KEY=LOW..HIGH:log or KEY=VALUE,VALUE,…")
    if key in REFUSED:
        raise Failure(f"--over {text}: {key} cannot be tuned: {REFUSED[key]}")
    if key == "fitness" or f"{key}.".startswith("fitness.0."):
        raise Failure(
            f"--over {text}: {key} cannot be tuned: it changes what the score means; tune keys of other tables"
        )
    is_range = ".." in values and not any(mark in values for mark in "\"'[{")
    return parse_numbers(text, key, values) if is_range else parse_categories(text, key, values)


def parse_numbers(text, key, values):
    ends, colon, scale = values.partition(":")
    low, _, high = ends.partition("..")
    if colon and scale != "log":
        raise Failure(f"--over {text}: {scale}: unknown scale; expected LOW..HIGH:log, or LOW..HIGH alone")
    for end in (low, high):
        if not NUMBER.fullmatch(end) or not math.isfinite(float(end)):
            raise Failure(f"--over {text}: {end}: expected a finite number on each side of the two dots, as in 0.5..4")
    whole = all(map(WHOLE.fullmatch, (low, high)))
    low, high = map(int if whole else float, (low, high))
    if low >= high:
        raise Failure(f"--over {text}: {low} is not below {high}; give the lower end first")
    if not whole and not math.isfinite(high - low):
        raise Failure(f"--over {text}: the range is too wide; bring the ends closer together")
    if scale and low <= 0:
        raise Failure(f"--over {text}: {low}: a logarithmic range begins above 0; raise that end, or leave out :log")
    return Numbers(key, low, high, bool(scale), whole)


def parse_categories(text, key, values):
    texts = split_values(values)
    if len(texts) < 2 or not all(map(str.strip, texts)):
        raise Failure(f"--over {text}: {values}: expected at least two values between commas, or a range LOW..HIGH")
    # as in --set, what is no value in TOML is a text
    texts = [
        value.strip() if toml_value(value) is not None else json.dumps(value.strip(), ensure_ascii=False)
        for value in texts
    ]
    for i, value in enumerate(texts):
        if any(same(toml_value(value), toml_value(other)) for other in texts[:i]):
            raise Failure(f"--over {text}: {value}: given twice; give each value once")
    return Categories(key, tuple(texts))
