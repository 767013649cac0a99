"""A body of masses and springs."""

import dataclasses

import numpy as np
import pandas as pd

MATERIAL = ["stiffness", "amplitude", "frequency", "phase", "damping"]  # the numbers of a material


@dataclasses.dataclass(frozen=True, eq=False)
class Body:
    """A body: point masses joined by springs. n is the number of masses, m that of springs.

    A body without `velocities` is not born yet: its positions are its rest positions, and at birth the scene adds its
    payload and puts it on the ground. A body with velocities is in the middle of its life. Arguments may be lists;
    `masses` may be one number for all, and `materials` anything of which pandas makes a DataFrame. Parameters of
    materials that are left out are 0.
    """

    positions: np.ndarray  #: [n, 3] m
    springs: np.ndarray  #: [m, 2] indices of the masses that each spring joins
    masses: np.ndarray  #: [n] kg; `evodevo.core` holds masses of 0 kg in place
    materials: pd.DataFrame  #: stiffness (N/m), amplitude (1), frequency (Hz), phase (rad), damping (1), by index
    rest_lengths: np.ndarray = None  #: [m] m; by default, the distances of the masses
    material_of: np.ndarray = 0  #: [m] the row of `materials` of each spring
    velocities: np.ndarray = None  #: [n, 3] m/s; None if the body is not born yet
    time: float = 0.0  #: since birth, s
    start_energy: float = None  #: energy that the guard against divergence allows, J; None: that of the body
    stiffness_factors: np.ndarray = 1.0  #: [m] stiffness of each spring relative to that of its material
    mass_materials: np.ndarray = -1  #: [n] the row of `materials` of each mass; -1 if it has none
    identities: np.ndarray = None  #: [n] uint64, what each mass descends from; by default, the indices

    def __post_init__(self):
        positions = _array("positions", self.positions, float, (None, 3))
        springs = _array("springs", self.springs, int, (None, 2))
        n, m = len(positions), len(springs)
        materials = pd.DataFrame(self.materials).copy()
        if unknown := [name for name in materials if name not in (*MATERIAL, "name")]:
            raise ValueError(f"materials: {unknown[0]!r} is not known; expected some of {', '.join(MATERIAL)}")
        for name in MATERIAL:
            materials[name] = materials[name].astype(float) if name in materials else 0.0
        rest_lengths = self.rest_lengths
        if rest_lengths is None:
            if m and not (0 <= springs.min() and springs.max() < n):
                ends = f"{springs.min()} to {springs.max()}"
                raise ValueError(f"springs: join masses {ends}; expected indices of {n} masses")
            rest_lengths = np.linalg.norm(positions[springs[:, 1]] - positions[springs[:, 0]], axis=1)
        velocities, start_energy = self.velocities, self.start_energy
        identities = _identities(range(n) if self.identities is None else self.identities)
        for name, value in {
            "positions": positions,
            "springs": springs,
            "masses": _array("masses", self.masses, float, (n,)),
            "materials": materials,
            "rest_lengths": _array("rest_lengths", rest_lengths, float, (m,)),
            "material_of": _array("material_of", self.material_of, int, (m,)),
            "velocities": None if velocities is None else _array("velocities", velocities, float, (n, 3)),
            "time": _number("time", self.time),
            "start_energy": None if start_energy is None else _number("start_energy", start_energy),
            "stiffness_factors": _array("stiffness_factors", self.stiffness_factors, float, (m,)),
            "mass_materials": _array("mass_materials", self.mass_materials, int, (n,)),
            "identities": _array("identities", identities, np.uint64, (n,)),
        }.items():
            object.__setattr__(self, name, value)

    @staticmethod
    def from_json(json):
        """Makes a body of the JSON that `evodevo body` prints, or that `evodevo simulate` reads."""
        masses, springs = json["masses"], json["springs"]
        is_alive = "time" in json
        return Body(
            positions=[mass["position"] for mass in masses],
            springs=[[spring["a"], spring["b"]] for spring in springs],
            masses=[mass["mass"] for mass in masses],
            materials=[{"damping": 0.0, **material} for material in json["materials"]],
            rest_lengths=[spring["rest_length"] for spring in springs],
            material_of=[spring["material"] for spring in springs],
            velocities=[mass.get("velocity", [0, 0, 0]) for mass in masses] if is_alive else None,
            time=json.get("time", 0),
            start_energy=json.get("start_energy"),
            stiffness_factors=[spring.get("stiffness_factor", 1) for spring in springs],
            mass_materials=[mass.get("material", -1) for mass in masses],
            identities=[mass.get("identity", i) for i, mass in enumerate(masses)],
        )

    @property
    def json(self):
        """The body as JSON that `evodevo simulate` reads."""
        masses = [{"position": position} for position in self.positions.tolist()]
        if self.velocities is not None:
            for mass, velocity in zip(masses, self.velocities.tolist()):
                mass["velocity"] = velocity
        for mass, weight, material, identity in zip(masses, self.masses.tolist(), self.mass_materials.tolist(),
                                                    self.identities.tolist()):
            mass["mass"] = weight
            if material >= 0:
                mass["material"] = material
            mass["identity"] = identity
        springs = [{"a": a, "b": b, "rest_length": length, "material": material}
                   for (a, b), length, material in zip(self.springs.tolist(), self.rest_lengths.tolist(),
                                                       self.material_of.tolist())]
        for spring, factor in zip(springs, self.stiffness_factors.tolist()):
            if factor != 1:
                spring["stiffness_factor"] = factor
        materials = self.materials.to_dict("records")
        for material in materials:
            if material["damping"] == 0:
                del material["damping"]
            if not isinstance(material.get("name"), str):  # a mixture of other materials
                material.pop("name", None)
        json = {"masses": masses, "springs": springs, "materials": materials}
        if self.velocities is not None:
            json["time"] = self.time
            if self.start_energy is not None:
                json["start_energy"] = self.start_energy
        return json

    @property
    def size(self):
        """The longest side of the bounding box, m."""
        return float(np.ptp(self.positions, axis=0).max()) if len(self.positions) else 0.0

    @property
    def is_muscle(self):
        """[m] whether the material of each spring has an amplitude."""
        return self.materials["amplitude"].to_numpy()[self.material_of] != 0


def _number(name, value):
    """Returns a value as a number. Raises ValueError."""
    try:
        return float(value)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: {error}; expected a number") from None


def _identities(values):
    """Returns identities as an array. Raises ValueError."""
    try:
        return np.array(values, dtype=np.uint64)  # of a list with large numbers, numpy would make floats
    except (TypeError, ValueError, OverflowError) as error:
        raise ValueError(f"identities: {error}; expected whole numbers from 0 to 2^64 - 1") from None


def _array(name, values, kind, shape):
    """Returns values as a new array of a shape, in which None stands for any number of rows; one number stands for a
    whole list. Raises ValueError."""
    values = np.array(values)
    if values.size == 0 and shape[0] in (None, 0):
        return np.zeros((0, *shape[1:]), kind)
    if values.ndim == 0 and len(shape) == 1:
        values = np.full(shape, values)
    if values.ndim != len(shape) or any(wanted not in (None, size) for size, wanted in zip(values.shape, shape)):
        expected = ", ".join("any" if size is None else str(size) for size in shape)
        raise ValueError(f"{name}: has the shape {values.shape}; expected [{expected}]")
    if kind is int and not np.issubdtype(values.dtype, np.integer):
        raise ValueError(f"{name}: has numbers of the type {values.dtype}; expected whole numbers, which are indices")
    try:
        return values.astype(kind)
    except (TypeError, ValueError) as error:
        raise ValueError(f"{name}: {error}; expected numbers") from None
