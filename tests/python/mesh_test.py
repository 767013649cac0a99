"""Tests meshes of bodies: they are closed, look outwards, and have the size of the body; files hold what they should."""

import struct
import tempfile
import unittest
from pathlib import Path

import numpy as np
import package  # noqa: F401: finds the package

import evodevo
from evodevo.mesh import SIDES, mesh_of, save_mesh

BODY = evodevo.Body.from_json({
    "materials": [{"stiffness": 4000.0, "amplitude": 0.0, "frequency": 0.0, "phase": 0.0},
                  {"stiffness": 5000.0, "amplitude": 0.14, "frequency": 1.0, "phase": 0.0}],
    "masses": [{"position": place, "mass": 0.2} for place in ([0, 0, 0], [1, 0, 0], [0.3, 0.9, 0.1], [0, 0, 2])],
    "springs": [{"a": 0, "b": 1, "rest_length": 1.0, "material": 0}, {"a": 1, "b": 2, "rest_length": 1.0, "material": 1},
                {"a": 3, "b": 0, "rest_length": 2.0, "material": 1}],
})


def volume(vertices, triangles):
    corners = vertices[triangles]
    return np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6


class Mesh(unittest.TestCase):
    def test_is_closed_and_looks_outwards(self):
        vertices, triangles, _ = mesh_of(BODY, 0.1)
        edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
        there = {tuple(edge) for edge in edges}
        self.assertEqual(len(there), len(edges), "each edge has one triangle on its left")
        self.assertEqual(there, {(b, a) for a, b in there}, "and one on its right")
        self.assertEqual(len(np.unique(triangles)), len(vertices))

    def test_has_the_volume_of_its_prisms_and_balls(self):
        radius, length = 0.05, 1 + np.linalg.norm([0.7, 0.9, 0.1]) + 2
        polygon = SIDES / 2 * radius**2 * np.sin(2 * np.pi / SIDES)
        icosahedron = 2.536 * radius**3  # of this circumradius
        self.assertAlmostEqual(volume(*mesh_of(BODY, 2 * radius)[:2]), polygon * length + 4 * icosahedron, places=6)

    def test_reaches_as_far_as_the_body(self):
        vertices, _, colours = mesh_of(BODY)
        self.assertLess(np.abs(vertices.min(axis=0) - [0, 0, 0]).max(), BODY.size / 50)
        self.assertLess(np.abs(vertices.max(axis=0) - [1, 0.9, 2]).max(), BODY.size / 50)
        self.assertEqual(len(np.unique(colours, axis=0)), 3, "muscles, other springs, masses")

    def test_of_unusual_bodies(self):
        point = evodevo.Body.from_json({**BODY.json, "masses": [{"position": [1, 2, 3], "mass": 1}] * 2,
                                        "springs": [{"a": 0, "b": 1, "rest_length": 0.1, "material": 0}]})
        with self.assertRaisesRegex(ValueError, "thickness"):
            mesh_of(point)
        self.assertEqual(len(mesh_of(point, 0.1)[1]), 2 * 20, "a spring without length has no prism")
        self.assertEqual(len(mesh_of(evodevo.Body.from_json({**BODY.json, "springs": []}), 0.1)[1]), 4 * 20)

    def test_files_hold_all_triangles(self):
        vertices, triangles, colours = mesh_of(BODY, 0.1)
        scratch = self.enterContext(tempfile.TemporaryDirectory())
        for ending in ("ply", "obj", "stl"):
            save_mesh(BODY, Path(scratch, f"robot.{ending}"), 0.1)
        stl = Path(scratch, "robot.stl").read_bytes()
        self.assertEqual(struct.unpack("<I", stl[80:84])[0], len(triangles))
        self.assertEqual(len(stl), 84 + 50 * len(triangles))
        first = np.frombuffer(stl, "<f4", 12, 84).reshape(4, 3)
        np.testing.assert_allclose(first[1:], vertices[triangles[0]], atol=1e-6)
        self.assertGreater(first[0] @ (first[1] - vertices[16]), 0, "the normal looks away from the axis")
        header, data = Path(scratch, "robot.ply").read_bytes().split(b"end_header\n")
        self.assertIn(f"element vertex {len(vertices)}\n".encode(), header)
        self.assertEqual(len(data), 15 * len(vertices) + 13 * len(triangles))
        np.testing.assert_array_equal(np.frombuffer(data[12:15], "u1"), colours[0])
        obj = Path(scratch, "robot.obj").read_text().splitlines()
        self.assertEqual(sum(line.startswith("v ") for line in obj), len(vertices))
        corners = [int(word) for line in obj if line.startswith("f ") for word in line.split()[1:]]
        self.assertEqual((min(corners), max(corners)), (1, len(vertices)))
        with self.assertRaisesRegex(ValueError, "robot.glb.*.ply"):
            save_mesh(BODY, Path(scratch, "robot.glb"))


unittest.main()
