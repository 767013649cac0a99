"""A body as a surface, for printing and rendering."""

import pathlib
import struct

import numpy as np

SIDES = 8  # of the prism of a spring
MUSCLE, PASSIVE, MASS = (200, 60, 50), (150, 150, 150), (90, 90, 90)  # red, green, blue


def mesh_of(body, thickness=None):
    """Returns a body as closed surfaces: a prism for each spring and a ball for each mass, which overlap.

    `thickness` is the diameter of both, m; by default, a fiftieth of the size of the body. Returns the vertices
    ([v, 3], m), the triangles ([t, 3] indices of vertices, counterclockwise seen from outside) and the colours of the
    vertices ([v, 3] numpy.uint8): muscles are red. Springs of length 0 have no prism.
    """
    radius = (body.size / 50 if thickness is None else thickness) / 2
    if not radius > 0:
        raise ValueError(f"thickness = {thickness}: a mesh needs a thickness above 0 m")
    ends = body.positions[body.springs]  # [m, 2, 3]
    long_enough = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1) > 1e-9 * max(body.size, 1e-9)
    vertices, triangles = _prisms(ends[long_enough], radius)
    colours = np.where(body.is_muscle[long_enough, None, None], np.array(MUSCLE), np.array(PASSIVE))
    colours = np.repeat(colours, 2 * SIDES + 2, axis=1).reshape(-1, 3)
    ball, faces = _ball()
    balls = (body.positions[:, None] + radius * ball).reshape(-1, 3)
    ball_faces = (len(vertices) + len(ball) * np.arange(len(body.positions))[:, None, None] + faces).reshape(-1, 3)
    all_colours = np.concatenate([colours, np.tile(MASS, (len(balls), 1))])
    return (np.concatenate([vertices, balls]), np.concatenate([triangles, ball_faces]).astype(np.int64),
            all_colours.astype(np.uint8))


def _prisms(ends, radius):
    """Returns the vertices and triangles of a prism around each of [m, 2, 3] pairs of points."""
    along = ends[:, 1] - ends[:, 0]
    along = along / np.maximum(np.linalg.norm(along, axis=1, keepdims=True), 1e-300)
    # an axis that is not parallel to the prism
    other = np.eye(3)[np.argmin(np.abs(along), axis=1)] if len(along) else np.zeros((0, 3))
    first = np.cross(along, other)
    first /= np.maximum(np.linalg.norm(first, axis=1, keepdims=True), 1e-300)
    second = np.cross(along, first)
    angles = 2 * np.pi * np.arange(SIDES) / SIDES
    cosine, sine = np.cos(angles)[:, None], np.sin(angles)[:, None]
    ring = radius * (cosine * first[:, None] + sine * second[:, None])  # [m, SIDES, 3]
    # both rings, then both ends
    vertices = np.concatenate([ends[:, :1] + ring, ends[:, 1:] + ring, ends], axis=1)
    i, j = np.arange(SIDES), (np.arange(SIDES) + 1) % SIDES
    low, high = np.full(SIDES, 2 * SIDES), np.full(SIDES, 2 * SIDES + 1)
    of_one = np.concatenate([np.stack(three, axis=1) for three in
                             ((i, j, SIDES + j), (i, SIDES + j, SIDES + i), (low, j, i), (high, SIDES + i, SIDES + j))])
    first_of = (2 * SIDES + 2) * np.arange(len(ends))
    return vertices.reshape(-1, 3), (first_of[:, None, None] + of_one).reshape(-1, 3)


def _ball():
    """Returns the vertices ([v, 3], of length 1) and triangles of an icosahedron."""
    golden = (1 + 5**0.5) / 2
    vertices = np.array([(-1, golden, 0), (1, golden, 0), (-1, -golden, 0), (1, -golden, 0),
                         (0, -1, golden), (0, 1, golden), (0, -1, -golden), (0, 1, -golden),
                         (golden, 0, -1), (golden, 0, 1), (-golden, 0, -1), (-golden, 0, 1)])
    triangles = np.array([(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                          (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
                          (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)])
    return vertices / np.linalg.norm(vertices[0]), triangles


def save_mesh(body, file, thickness=None):
    """Writes mesh_of(body, thickness) to a file: .ply (binary, with colours), .obj or .stl (binary, without colours).
    Lengths are in metres. Raises ValueError for another ending."""
    file = pathlib.Path(file)
    write = {".ply": _write_ply, ".obj": _write_obj, ".stl": _write_stl}.get(file.suffix.lower())
    if write is None:
        raise ValueError(f"{file}: expected a name ending in .ply, .obj or .stl")
    vertices, triangles, colours = mesh_of(body, thickness)
    with open(file, "wb") as stream:
        write(stream, vertices, triangles, colours)


def _write_ply(stream, vertices, triangles, colours):
    stream.write(f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\n"
                 "property float y\nproperty float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
                 f"element face {len(triangles)}\nproperty list uchar int vertex_indices\nend_header\n".encode())
    points = np.empty(len(vertices), [("place", "<f4", 3), ("colour", "u1", 3)])
    points["place"], points["colour"] = vertices, colours
    faces = np.empty(len(triangles), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, triangles
    stream.write(points.tobytes() + faces.tobytes())


def _write_obj(stream, vertices, triangles, _):
    np.savetxt(stream, vertices, "v %.9g %.9g %.9g")
    np.savetxt(stream, triangles + 1, "f %d %d %d")


def _write_stl(stream, vertices, triangles, _):
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    facets = np.zeros(len(triangles), [("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("unused", "<u2")])
    facets["normal"], facets["corners"] = normals, corners
    stream.write(b"a body of evodevo, in metres".ljust(80) + struct.pack("<I", len(triangles)) + facets.tobytes())
