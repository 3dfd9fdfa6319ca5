#!/usr/bin/env python3
"""Makes the parts and scans of this folder: the same files every time.

bracket.stl       a stepped bracket, 50 x 30 x 24 mm
bracket-scan.csv  its sides that one scanner sees, somewhere in space: noise 5 um, 10 % stray points,
                  and one step that stands 100 um too high
pin.stl           a pin, 12 mm thick and 30 mm long, with a chamfer at one end
pin-scan.csv      its wall and its chamfered end: nothing shows how it is turned about its axis
"""
import math
import pathlib
import random
import struct

FOLDER = pathlib.Path(__file__).parent
# With every corner of the squares that make up the profile, so that edges meet edges.
BRACKET = [(0, 0), (20, 0), (38, 0), (50, 0), (50, 6), (38, 6), (38, 17), (20, 17), (20, 30), (0, 30), (0, 17), (0, 6)]
SQUARES = [(x, y, u, v) for x, u, top in [(0, 20, 30), (20, 38, 17), (38, 50, 6)]
           for y, v in [(0, 6), (6, 17), (17, 30)] if v <= top]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def bracket():
    height = 24
    triangles = []
    for (x, y), (u, v) in zip(BRACKET, BRACKET[1:] + BRACKET[:1]):
        low, right, high, left = (x, y, 0), (u, v, 0), (u, v, height), (x, y, height)
        triangles += [(low, right, high), (low, high, left)]
    for x, y, u, v in SQUARES:
        for z in (0, height):
            corners = [(x, y, z), (u, y, z), (u, v, z), (x, v, z)]
            if z == 0:
                corners.reverse()
            triangles += [tuple(corners[:3]), (corners[0], corners[2], corners[3])]
    return triangles


def pin(around=120):
    rings = [(6, 0), (6, 28.5), (4.5, 30)]
    place = lambda r, z, k: (r * math.cos(2 * math.pi * k / around), r * math.sin(2 * math.pi * k / around), z)
    triangles = []
    for k in range(around):
        for (r, z), (s, w) in zip(rings, rings[1:]):
            a, b, c, d = place(r, z, k), place(r, z, k + 1), place(s, w, k + 1), place(s, w, k)
            triangles += [(a, b, c), (a, c, d)]
        triangles += [((0, 0, 0), place(6, 0, k + 1), place(6, 0, k)), ((0, 0, 30), place(4.5, 30, k), place(4.5, 30, k + 1))]
    return triangles


def normal_of(triangle):
    normal = cross(minus(triangle[1], triangle[0]), minus(triangle[2], triangle[0]))
    length = math.sqrt(sum(x * x for x in normal))
    return tuple(x / length for x in normal), length / 2


def write_stl(name, triangles):
    data = b"binary STL, mm".ljust(80) + struct.pack("<I", len(triangles))
    for triangle in triangles:
        data += struct.pack("<12fH", *normal_of(triangle)[0], *[x for corner in triangle for x in corner], 0)
    (FOLDER / name).write_bytes(data)


def sample(triangles, count, numbers, seen):
    """Points with normals, evenly spread over the triangles that are seen."""
    parts = [(t, *normal_of(t)) for t in triangles]
    parts = [p for p in parts if seen(p[0], p[1])]
    result = []
    for (a, b, c), normal, _ in numbers.choices(parts, [p[2] for p in parts], k=count):
        u, v = numbers.random(), numbers.random()
        if u + v > 1:
            u, v = 1 - u, 1 - v
        result.append((tuple(a[i] + u * (b[i] - a[i]) + v * (c[i] - a[i]) for i in range(3)), normal))
    return result


def turned(point, axis, angle, shift):
    """Rodrigues."""
    length = math.sqrt(sum(x * x for x in axis))
    k = tuple(x / length for x in axis)
    along = sum(x * y for x, y in zip(k, point)) * (1 - math.cos(angle))
    sideways = cross(k, point)
    return tuple(math.cos(angle) * point[i] + math.sin(angle) * sideways[i] + along * k[i] + shift[i] for i in range(3))


def write_scan(name, points, remark):
    lines = [f"# {remark}", "x_mm,y_mm,z_mm"]
    lines += [",".join(f"{x:.4f}" for x in point) for point in points]
    (FOLDER / name).write_text("\n".join(lines) + "\n")


def main():
    numbers = random.Random(1)
    write_stl("bracket.stl", bracket())
    side = (0.3, 0.6, 0.7)
    scan = []
    for point, normal in sample(bracket(), 2000, numbers, lambda t, n: sum(a * b for a, b in zip(n, side)) > 0.1):
        off = numbers.gauss(0, 0.005)
        if normal[1] > 0.5 and abs(point[1] - 17) < 1e-9:
            off += 0.100
        point = tuple(point[i] + off * normal[i] for i in range(3))
        if numbers.random() < 0.1:
            point = tuple(numbers.uniform(-5, limit) for limit in (55, 35, 29))
        scan.append(turned(point, (1, -2, 0.5), 2.2, (120, -40, 310)))
    write_scan("bracket-scan.csv", scan, "scan of bracket.stl: noise 5 um, 10 % stray points, the step at y = 17 mm 100 um too high")

    write_stl("pin.stl", pin())
    scan = []
    for point, normal in sample(pin(), 1200, numbers, lambda t, n: n[2] > -0.5):
        off = numbers.gauss(0, 0.004)
        scan.append(turned(tuple(point[i] + off * normal[i] for i in range(3)), (0.2, 1, 0.4), 1.1, (-15, 60, 205)))
    write_scan("pin-scan.csv", scan, "scan of pin.stl: noise 4 um")


main()
