"""Triangle meshes with smooth normals, as binary PLY files.

A mesh is a pair (vertices, triangles): each vertex is a tuple (x, y, z, nx, ny, nz), each triangle
three indices, counter-clockwise seen from the side of its normals.
"""

import math
import struct


def write_ply(path, mesh, normals=True):
    """Writes a mesh as little-endian PLY: float32 positions and, unless left out, normals; int32
    indices."""
    vertices, triangles = mesh
    names = ("x", "y", "z", "nx", "ny", "nz")[: 6 if normals else 3]
    header = "\n".join(
        ["ply", "format binary_little_endian 1.0", f"element vertex {len(vertices)}"]
        + [f"property float {name}" for name in names]
        + [f"element face {len(triangles)}", "property list uchar int vertex_indices", "end_header", ""]
    )
    body = [struct.pack(f"<{len(names)}f", *vertex[: len(names)]) for vertex in vertices]
    body += [struct.pack("<B3i", 3, *triangle) for triangle in triangles]
    path.write_bytes(header.encode("ascii") + b"".join(body))


def lattice(columns, rows, wrap_columns=False, wrap_rows=False):
    """Triangles that join a lattice of vertices stored row by row. With columns along u and rows
    along v the normals lie along du x dv."""
    triangles = []
    for row in range(rows if wrap_rows else rows - 1):
        for column in range(columns if wrap_columns else columns - 1):
            right, below = (column + 1) % columns, (row + 1) % rows
            a, b = row * columns + column, row * columns + right
            c, d = below * columns + right, below * columns + column
            triangles += [(a, b, c), (a, c, d)]
    return triangles


def normalised(x, y, z):
    """The vector at unit length."""
    length = math.sqrt(x * x + y * y + z * z)
    return (x / length, y / length, z / length)


def heightfield(height, slope, x_range, z_range, columns, rows):
    """The surface y = height(x, z) over a rectangle, normals up; slope gives (dy/dx, dy/dz)."""
    vertices = []
    for row in range(rows):
        # From large z to small z, so that du x dv points up.
        z = z_range[1] + (z_range[0] - z_range[1]) * row / (rows - 1)
        for column in range(columns):
            x = x_range[0] + (x_range[1] - x_range[0]) * column / (columns - 1)
            dx, dz = slope(x, z)
            vertices.append((x, height(x, z), z, *normalised(-dx, 1.0, -dz)))
    return vertices, lattice(columns, rows)


def torus(major, minor, columns, rows):
    """A torus around the y axis, normals outward."""
    vertices = []
    for row in range(rows):
        v = -2.0 * math.pi * row / rows
        for column in range(columns):
            u = 2.0 * math.pi * column / columns
            normal = (math.cos(v) * math.cos(u), math.sin(v), math.cos(v) * math.sin(u))
            ring = major + minor * math.cos(v)
            vertices.append((ring * math.cos(u), minor * math.sin(v), ring * math.sin(u), *normal))
    return vertices, lattice(columns, rows, wrap_columns=True, wrap_rows=True)


def revolution(profile, columns):
    """The surface of revolution around the y axis of a list of (radius, y, normal_radius,
    normal_y), given so that the normal lies to the left of the way along the profile as drawn with
    the radius to the right and y up."""
    vertices = []
    for radius, y, normal_radius, normal_y in profile:
        for column in range(columns):
            u = 2.0 * math.pi * column / columns
            cos, sin = math.cos(u), math.sin(u)
            normal = normalised(normal_radius * cos, normal_y, normal_radius * sin)
            vertices.append((radius * cos, y, radius * sin, *normal))
    return vertices, [
        triangle for triangle in lattice(columns, len(profile), wrap_columns=True)
        if has_area(vertices, triangle)
    ]


def has_area(vertices, triangle):
    """False where a pole of a surface of revolution has drawn two corners together."""
    corners = [vertices[index][:3] for index in triangle]
    return all(math.dist(corners[i], corners[i - 1]) > 1e-9 for i in range(3))


def polyline(points):
    """A profile of straight segments with sharp corners: each segment has its own normals."""
    profile = []
    for (r0, y0), (r1, y1) in zip(points, points[1:]):
        profile += [(r0, y0, y0 - y1, r1 - r0), (r1, y1, y0 - y1, r1 - r0)]
    return profile
