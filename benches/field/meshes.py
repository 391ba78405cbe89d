"""Triangle meshes: the shapes of a scene, and the PLY files that all three programs read."""

from dataclasses import dataclass, replace

import mitsuba as mi
import numpy as np


@dataclass(frozen=True)
class Mesh:
    """`normals` (of unit length, for smooth shading) and `uvs` have one row per vertex, or are None."""

    positions: np.ndarray
    faces: np.ndarray
    normals: np.ndarray | None = None
    uvs: np.ndarray | None = None

    def transformed(self, matrix):
        """Transforms the mesh by an affine map with positive determinant."""
        linear, offset = matrix[:3, :3], matrix[:3, 3]
        normals = self.normals
        if normals is not None:
            normals = normals @ np.linalg.inv(linear)
            normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        return replace(self, positions=self.positions @ linear.T + offset, normals=normals)

    def scaled(self, factor):
        return replace(self, positions=self.positions * factor)

    def moved(self, offset):
        return replace(self, positions=self.positions + offset)

    def area(self):
        a, b, c = (self.positions[self.faces[:, i]] for i in range(3))
        return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2

    def flat_with_area(self, area):
        """Removes smooth normals and scales the mesh about the origin to the given area."""
        return replace(self.scaled(np.sqrt(area / self.area())), normals=None)

    def write_ply(self, path):
        """Writes a binary PLY file with the property names that Mitsuba, LuxCore and Metrolight share."""
        columns = {"x": self.positions[:, 0], "y": self.positions[:, 1], "z": self.positions[:, 2]}
        if self.normals is not None:
            columns |= {f"n{axis}": self.normals[:, i] for i, axis in enumerate("xyz")}
        if self.uvs is not None:
            columns |= {"s": self.uvs[:, 0], "t": self.uvs[:, 1]}
        vertices = np.zeros(len(self.positions), dtype=[(name, "<f4") for name in columns])
        for name, values in columns.items():
            vertices[name] = values
        faces = np.zeros(len(self.faces), dtype=[("count", "u1"), ("indices", "<i4", 3)])
        faces["count"], faces["indices"] = 3, self.faces
        properties = "".join(f"property float {name}\n" for name in columns)
        header = (
            f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\n{properties}"
            f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
        )
        path.write_bytes(header.encode() + vertices.tobytes() + faces.tobytes())


def rectangle():
    """Mitsuba's rectangle: from -1 to 1 in x and y, with the normal along z."""
    uvs = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
    positions = np.column_stack([2 * uvs - 1, np.zeros(4)])
    return Mesh(positions, np.array([[0, 1, 2], [0, 2, 3]]), uvs=uvs)


def cube():
    """The cube from -1 to 1 in all axes, with outward normals."""
    faces = []
    for axis in range(3):
        turn = np.roll(np.eye(4)[:3, :3], axis, axis=0)
        for side in (1, -1):
            to_side = np.eye(4)
            to_side[:3, :3] = turn @ np.diag([side, 1, side])
            to_side[:3, 3] = to_side[:3, 2]
            faces.append(rectangle().transformed(to_side))
    return Mesh(
        np.concatenate([face.positions for face in faces]),
        np.concatenate([face.faces + 4 * i for i, face in enumerate(faces)]),
        uvs=np.concatenate([face.uvs for face in faces]),
    )


def sphere(rows):
    """The unit sphere about the origin, with `rows` rows from pole to pole, twice as many columns, and outward normals."""
    columns = 2 * rows
    theta, phi = np.meshgrid(
        np.linspace(0, np.pi, rows + 1), np.linspace(0, 2 * np.pi, columns, endpoint=False), indexing="ij"
    )
    points = np.stack([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)], axis=-1)
    points = points.reshape(-1, 3)
    faces = []
    for row in range(rows):
        for column in range(columns):
            next_column = (column + 1) % columns
            a, b = row * columns + column, row * columns + next_column
            c, d = a + columns, b + columns
            if row > 0:
                faces.append([a, c, b])
            if row < rows - 1:
                faces.append([b, c, d])
    return Mesh(points, np.array(faces), normals=points.copy())


def from_file(path):
    """Reads a PLY file with Mitsuba."""
    params = mi.traverse(mi.load_dict({"type": "ply", "filename": str(path)}))

    def rows(name, width):
        values = np.array(params[name], dtype=float)
        return values.reshape(-1, width) if len(values) else None

    faces = np.array(params["faces"]).reshape(-1, 3)
    return Mesh(rows("vertex_positions", 3), faces, rows("vertex_normals", 3), rows("vertex_texcoords", 2))
