"""A body of masses and springs."""

import dataclasses

import numpy as np
import pandas as pd


@dataclasses.dataclass(frozen=True)
class Body:
    """A body as `evodevo body` prints it. n is the number of masses, m that of springs."""

    positions: np.ndarray  #: [n, 3] rest positions, m
    masses: np.ndarray  #: [n] kg
    springs: np.ndarray  #: [m, 2] indices of the masses that each spring joins
    rest_lengths: np.ndarray  #: [m] m
    materials: pd.DataFrame  #: stiffness (N/m), amplitude (1), frequency (Hz), phase (rad), damping (1), by index
    material_of: np.ndarray  #: [m] the row of `materials` of each spring
    time: float  #: since birth, s; 0 for a newborn
    json: dict  #: all that the program prints

    @staticmethod
    def from_json(json):
        """Makes a body of the JSON that `evodevo body` prints, or that `evodevo simulate` reads."""
        masses, springs = json["masses"], json["springs"]
        return Body(
            positions=np.array([mass["position"] for mass in masses], float).reshape(-1, 3),
            masses=np.array([mass["mass"] for mass in masses], float),
            springs=np.array([[spring["a"], spring["b"]] for spring in springs], int).reshape(-1, 2),
            rest_lengths=np.array([spring["rest_length"] for spring in springs], float),
            materials=pd.DataFrame(json["materials"]),
            material_of=np.array([spring["material"] for spring in springs], int),
            time=float(json.get("time", 0)),
            json=json,
        )

    @property
    def size(self):
        """The longest side of the bounding box, m."""
        return float(np.ptp(self.positions, axis=0).max()) if len(self.positions) else 0.0

    @property
    def is_muscle(self):
        """[m] whether the material of each spring has an amplitude."""
        return self.materials["amplitude"].to_numpy()[self.material_of] != 0
