"""Draws experiments at random: any operators with any parameters in their ranges, in any scene, but small enough that a
run takes a fraction of a second."""

import re

# largest value of each parameter that decides how much there is to simulate; whatever is drawn stays below
SMALL = {
    "points": 40,
    "neighbours": 10,
    "size": 3,
    "hidden": 6,
    "layers": 3,
    "memory": 4,
    "masses": 4,
    "limit": 30,
    "springs": 20,
    "actions": 6,
    "length": 1.0,
    "resolution": 12,
    "steps": 20,
}
TIMES = ("settle", "window")  # multiples of 0.01 s, and so of every time step that is drawn
STEPS = (0.00025, 0.0005, 0.001)  # s
SENSE = 0.9  # share of the experiments in which what is drawn is made to fit together
DEFAULTS = 0.6  # probability that a key keeps its default
EXTREMES = 0.1  # probability that a number is an end of its range
SCENE = {
    "gravity": {"acceleration": (0, 20), "slope": (-30, 30)},
    "floor": {"restitution": (0, 1), "stiffness": (1e3, 1e6), "roughness": (0, 0.1), "wavelength": (0.5, 3)},
    "friction": {"coefficient": (0, 2), "static": (0, 3)},
    "damping": {"rate": (0, 30)},
    "drag": {"coefficient": (0, 3)},
    "payload": {"share": (0, 2), "top": (0, 1)},
}
MATERIALS = ("muscle", "muscle2", "tissue", "bone")
METHODS = ("paper-euler", "symplectic-euler", "velocity-verlet", "rk4", "implicit", "xpbd")


class Draw:
    """Draws from the operators that `evodevo operators --json` lists, with the random numbers of `random`. `device`
    simulates."""

    def __init__(self, operators, random, device="cpu"):
        self._operators, self._random, self._device = operators, random, device

    def experiment(self):
        """Returns the tables of an experiment as dictionaries and lists."""
        random = self._random
        tables = {
            "experiment": {
                "seed": random.randrange(2**53),
                "evaluations": random.randint(1, 24),
                "population": random.randint(1, 6),
                "children": random.randint(0, 7),
                "random_individuals": random.randint(0, 2),
                "verify": random.choice((0, 1, 1, 2)),
                "verify_front": random.choice(["off"] * 8 + ["trials", "lives"]),
                "lives": random.choice((1, 1, 1, 2, 3)),
                "birth_noise": random.choice((0, 0, 0, 0.001, 0.02)),
            },
            "encoding": self._operator("encoding"),
            "mutation": self._operators_of("mutation", 0, 3),
            "crossover": self._operators_of("crossover", 0, 2),
            "scene": self._scene(SCENE),
            "simulation": self._simulation(),
            "fitness": self._operators_of("fitness", 1, 3),
            "selection": self._operator("selection"),
        }
        if random.random() < 0.5:
            tables["materials"] = {name: self._material() for name in MATERIALS if random.random() < 0.5}
        if random.random() < 0.7:
            tables["development"] = self._development()
        if random.random() < 0.3:
            tables["scenario"] = [self._scenario(number) for number in range(random.randint(1, 3))]
        for i, each in enumerate(tables["fitness"]):
            each["label"] = f"score-{i}"
            if random.random() < 0.2:
                each["over_lives"] = random.choice(("median", "worst"))
        if random.random() < SENSE:
            self._fit_together(tables)
        return {name: table for name, table in tables.items() if table != []}

    def _fit_together(self, tables):
        """Mends combinations that `evodevo check` refuses."""
        experiment, scene, selection = tables["experiment"], tables["scene"], tables["selection"]
        random = self._random
        experiment["population"] = max(4, experiment["population"])
        experiment["children"] = max(4, experiment["children"])
        if random.random() < 0.1:
            selection["remeasure"] = random.randint(1, 4)
        if experiment["lives"] > 1 or "remeasure" in selection:
            experiment["birth_noise"] = experiment["birth_noise"] or 0.01
        for each in tables.get("scenario", ()):
            if each.get("repeat", 1) > 1:
                each.setdefault("start_noise", 0.01)
        if "floor" not in scene:
            scene.pop("friction", None)
        elif "restitution" in scene["floor"]:
            scene["floor"].pop("stiffness", None)
        if "static" in scene.get("friction", {}):
            scene["friction"]["static"] += scene["friction"].setdefault("coefficient", 0.5)
        if selection["name"] in ("cma-es", "differential"):
            tables["mutation"], tables["crossover"] = [], []
        if selection["name"] in ("tournament", "lexicase"):
            again = {"remeasure": selection.pop("remeasure")} if "remeasure" in selection else {}
            tables["selection"] = {"parents": selection, "survivors": {"name": "elitist"}, **again}
        if selection["name"] in ("map-elites", "novelty"):
            tables["fitness"].append({"name": "descriptor", "settle": 0.05, "window": 0.1, "label": "axis"})
        if tables["encoding"]["name"] != "neat":
            tables["mutation"] = [each for each in tables["mutation"] if each["name"] not in ("add-node", "add-link")]
        if not tables["mutation"] and not tables["crossover"] and selection["name"] not in ("cma-es", "differential"):
            tables["mutation"] = [{"name": "reset-weight", "probability": 0.9}]
        if all(each["name"] == "descriptor" for each in tables["fitness"]):
            tables["fitness"].insert(0, {"name": "distance", "settle": 0.05, "window": 0.1})
        if tables["simulation"].get("method") in ("implicit", "xpbd"):
            tables["simulation"]["dt"] = STEPS[0]
        development = tables.get("development", {})
        if not development.get("operator"):
            development.pop("control", None)
        for each in [tables["encoding"], *tables["fitness"], *development.get("operator", ())]:
            each.pop("developing", None)
            for less, most in [("low", "high"), *((key, f"most_{key}") for key in list(each))]:
                if less in each and most in each:
                    each[less], each[most] = sorted((each[less], each[most]))

    def _operator(self, kind):
        # a cloud needs a file
        of_kind = [each for each in self._operators if each["kind"] == kind and each["name"] != "cloud"]
        chosen = self._random.choice(of_kind)
        drawn = {each["name"]: self._value(each) for each in chosen["parameters"]}
        return {"name": chosen["name"], **{name: value for name, value in drawn.items() if value is not None}}

    def _operators_of(self, kind, least, most):
        drawn = [self._operator(kind) for _ in range(self._random.randint(least, most))]
        if kind in ("mutation", "crossover"):
            for each in drawn:
                each["probability"] = round(self._random.random(), 3)
        return drawn

    def _value(self, parameter):
        """Returns a value of a parameter, or None for its default."""
        kind, allowed, random = parameter["type"], parameter["allowed"], self._random
        small = SMALL.get(parameter["name"])
        if parameter["name"] in TIMES:
            return random.randint(1, 20) / 100
        if parameter["name"] == "rate" and parameter["unit"] == "1/s":
            return random.randint(100, 200)  # at least one sample in the shortest window
        if kind == "option":
            return random.choice(re.findall('"(.*?)"', allowed))
        if kind == "true or false":
            return random.random() < 0.5
        if kind == "names of materials":
            return random.sample([*MATERIALS, "air"], random.randint(0, 4))
        if kind in ("number", "whole number"):
            if small is None and random.random() < DEFAULTS:
                return None
            return self._number(parameter, small)
        if kind == "three whole numbers":
            return [self._number(parameter, small) for _ in range(3)]
        if kind == "three numbers":
            return [round(random.uniform(-2, 2), 3) for _ in range(3)]
        if kind == "list of numbers":
            return sorted(round(random.uniform(-1, 3), 3) for _ in range(2))
        return None  # files

    def _number(self, parameter, small):
        low, high = (float(end) for end in re.match(r"(\S+) to (\S+)", parameter["allowed"]).groups())
        high = high if small is None else min(high, small)
        if self._random.random() < EXTREMES and high - low < 1e4:
            value = self._random.choice((low, high))
        else:
            value = self._between(low, high, parameter["default"])
        is_whole = "whole" in parameter["type"]
        return round(value) if is_whole else float(f"{value:.4g}") if low <= float(f"{value:.4g}") <= high else value

    def _between(self, low, high, default):
        """Draws from a range: by the logarithm, and not far from the default, if the range is wide."""
        if high - low <= 100 or low < 0:
            return self._random.uniform(low, high)
        middle = float(default) if re.fullmatch(r"[-+.e\d]+", default) and float(default) > 0 else 1.0
        near = middle * 10 ** self._random.uniform(-1, 1)
        return min(high, max(low, near))

    def _scene(self, forces):
        scene = {}
        for force, keys in forces.items():
            if self._random.random() < (0.3 if force in ("drag", "payload") else 0.8):
                scene[force] = {
                    key: round(self._random.uniform(*ends), 4)
                    for key, ends in keys.items()
                    if self._random.random() > DEFAULTS
                }
        return scene

    def _simulation(self):
        random = self._random
        simulation = {"device": self._device, "precision": random.choice(("float", "double"))}
        if random.random() < 0.5:
            simulation["accuracy"] = random.choice(("paper", "fast", "balanced"))
        else:
            simulation["method"] = random.choice(METHODS)
            simulation["dt"] = random.choice(("auto", *STEPS))
        if random.random() < 0.2:
            simulation["unstable"] = random.choice(("invalid", "run"))
        return simulation

    def _material(self):
        random = self._random
        drawn = {
            "stiffness": round(10 ** random.uniform(1, 5), 1),
            "amplitude": round(random.uniform(0, 0.5), 3),
            "frequency": round(random.uniform(0, 8), 2),
            "phase": round(random.uniform(-7, 7), 3),
            "damping": round(random.uniform(0, 1.5), 3),
        }
        return {key: value for key, value in drawn.items() if random.random() > DEFAULTS}

    def _development(self):
        random = self._random
        cycles = random.randint(0, 4)
        operators = []
        for _ in range(random.randint(0, 3)):
            each = self._operator("devo")
            if random.random() < 0.3:
                each |= {"from": random.randint(1, 3), "every": random.randint(1, 2)}
            operators.append(each)
        development = {"cycles": cycles, "cycle_time": random.randint(2, 10) / 100}
        if random.random() < 0.3:
            development["reset"] = True
        if random.random() < 0.3:
            development |= {"draws": random.choice(("inherited", "individual")), "draws_between_lives": "new"}
        if random.random() < 0.2:
            development["control"] = random.choice(("no-change", "random-places", "shuffled-stress"))
        if random.random() < 0.1:
            development |= {"probe": "skip-shift", "skip": random.randint(1, 20)}
        return development | ({"operator": operators} if operators else {})

    def _scenario(self, number):
        random = self._random
        scenario = {"name": f"test {number}", **self._scene({force: SCENE[force] for force in ("gravity", "payload")})}
        for key, value in (
            ("start_noise", round(random.uniform(0, 0.02), 4)),
            ("muscles", random.random() < 0.7),
            ("damage", round(random.uniform(0, 0.5), 3)),
            ("repeat", random.randint(1, 2)),
            ("develops", random.random() < 0.3),
        ):
            if random.random() > DEFAULTS:
                scenario[key] = value
        return scenario


def without(tables):
    """Yields each variant of an experiment that lacks one table, one element of a list of tables, or one key."""

    def smaller(node):
        if isinstance(node, dict):
            for key in node:
                yield {other: value for other, value in node.items() if other != key}
            for key, value in node.items():
                for less in smaller(value):
                    yield node | {key: less}
        elif isinstance(node, list) and node and isinstance(node[0], dict):
            for i, value in enumerate(node):
                if len(node) > 1:
                    yield node[:i] + node[i + 1 :]
                for less in smaller(value):
                    yield [*node[:i], less, *node[i + 1 :]]

    yield from smaller(tables)


