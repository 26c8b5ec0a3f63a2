#!/usr/bin/env python3
"""Makes what the game's garden is built of: scripts/game/models/*.{cmodel,cmesh} and sky.png.

Faceted meshes with a colour of their own on every face, and a panorama of a moonlit night. Shapes
and colours come from seeded random numbers and are rounded before they are written.

    tools/make_garden.py [OUT_DIR]          (default scripts/game)
"""
import json
import math
import os
import random
import struct
import sys
import zlib

STONE, EARTH, GRASS = (0.30, 0.31, 0.34), (0.16, 0.12, 0.09), (0.07, 0.15, 0.05)
LEAF, PINE, BARK = (0.07, 0.19, 0.07), (0.04, 0.13, 0.08), (0.17, 0.11, 0.07)
WOOD, IRON, GOLD = (0.36, 0.22, 0.11), (0.05, 0.05, 0.06), (1.0, 0.72, 0.25)
TAU = 2 * math.pi


class Mesh:
    """Triangles with flat normals; `draw` is the model's own stream of random numbers."""

    def __init__(self, seed=1):
        self.position, self.normal, self.color = [], [], []
        self.draw = random.Random(seed)

    def shade(self, color, play):
        k = 1 + play * (2 * self.draw.random() - 1)
        return tuple(round(c * k, 4) for c in color) + (1.0,)

    def triangle(self, a, b, c, color):
        u, v = [b[i] - a[i] for i in range(3)], [c[i] - a[i] for i in range(3)]
        n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        length = math.sqrt(sum(x * x for x in n))
        if length < 1e-9:
            return
        self.position += [a, b, c]
        self.normal += [[x / length for x in n]] * 3
        self.color += [color] * 3

    def quad(self, a, b, c, d, color):
        self.triangle(a, b, c, color)
        self.triangle(a, c, d, color)

    def box(self, center, size, color, play=0.15, jitter=0.0, yaw=0.0):
        """An upright box; jitter moves its corners."""
        s, c = math.sin(yaw), math.cos(yaw)
        corner = []
        for i in range(8):
            x, y, z = ((0.5 if i >> k & 1 else -0.5) * size[k] + jitter * (self.draw.random() - 0.5)
                       for k in range(3))
            corner.append((center[0] + c * x + s * z, center[1] + y, center[2] - s * x + c * z))
        shade = self.shade(color, play)
        for face in ((0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)):
            self.quad(*(corner[k] for k in face), shade)

    def lathe(self, rings, color, sides=8, center=(0, 0, 0), play=0.12, turn=0.0):
        """Rings (height, radius) round the vertical through `center`, upwards, closed at both ends."""
        rows = [[(center[0] + r * math.cos(turn + TAU * k / sides), center[1] + y,
                  center[2] - r * math.sin(turn + TAU * k / sides)) for k in range(sides)] for y, r in rings]
        for low, high in zip(rows, rows[1:]):
            for k in range(sides):
                n = (k + 1) % sides
                self.quad(low[k], low[n], high[n], high[k], self.shade(color, play))
        for row, (y, r), top in ((rows[0], rings[0], False), (rows[-1], rings[-1], True)):
            middle = (center[0], center[1] + y, center[2])
            for k in range(sides if r > 0 else 0):
                n = (k + 1) % sides
                self.triangle(middle, *((row[k], row[n]) if top else (row[n], row[k])), self.shade(color, play))

    def tube(self, path, color, sides=6, play=0.12):
        """A bent round rod along points (x, y, z, radius)."""
        rows = []
        for i, p in enumerate(path):
            a, b = path[max(i - 1, 0)], path[min(i + 1, len(path) - 1)]
            d = [b[k] - a[k] for k in range(3)]
            length = math.sqrt(sum(x * x for x in d))
            d = [x / length for x in d]
            up = (0, 1, 0) if abs(d[1]) < 0.9 else (1, 0, 0)
            u = (up[1] * d[2] - up[2] * d[1], up[2] * d[0] - up[0] * d[2], up[0] * d[1] - up[1] * d[0])
            size = math.sqrt(sum(x * x for x in u))
            u = [x / size for x in u]
            v = (d[1] * u[2] - d[2] * u[1], d[2] * u[0] - d[0] * u[2], d[0] * u[1] - d[1] * u[0])
            rows.append([tuple(p[k] + p[3] * (math.cos(TAU * s / sides) * u[k] + math.sin(TAU * s / sides) * v[k])
                               for k in range(3)) for s in range(sides)])
        for low, high in zip(rows, rows[1:]):
            for k in range(sides):
                n = (k + 1) % sides
                self.quad(low[k], low[n], high[n], high[k], self.shade(color, play))
        for row, p, end in ((rows[0], path[0], False), (rows[-1], path[-1], True)):
            for k in range(sides):
                n = (k + 1) % sides
                self.triangle(p[:3], *((row[k], row[n]) if end else (row[n], row[k])), self.shade(color, play))

    def blob(self, center, radius, color, rough=0.18, detail=1, play=0.25):
        """A lumpy ball: an icosahedron, its edges halved `detail` times, corners moved in and out."""
        g = (1 + math.sqrt(5)) / 2
        points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
                  (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
        faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5),
                 (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
        for _ in range(detail):
            middle, finer = {}, []
            for f in faces:
                half = []
                for a, b in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0])):
                    key = (min(a, b), max(a, b))
                    if key not in middle:
                        middle[key] = len(points)
                        points.append(tuple((points[a][k] + points[b][k]) / 2 for k in range(3)))
                    half.append(middle[key])
                finer += [(f[0], half[0], half[2]), (f[1], half[1], half[0]), (f[2], half[2], half[1]), tuple(half)]
            faces = finer
        placed = []
        for p in points:
            k = (1 + rough * (2 * self.draw.random() - 1)) / math.sqrt(sum(x * x for x in p))
            placed.append(tuple(center[i] + radius[i] * k * p[i] for i in range(3)))
        for f in faces:
            a, b, c = (placed[k] for k in f)
            height = ((a[1] + b[1] + c[1]) / 3 - center[1]) / radius[1]
            shade = self.shade(color, play)
            self.triangle(a, b, c, tuple(x * (1 + 0.45 * height) for x in shade[:3]) + (1.0,))


# ---- models: each returns a list of (mesh, material) ----

MATTE = {"name": "matte", "roughness": 0.9}
GLOW = {"name": "glow", "roughness": 0.6, "emissive": [2.4, 0.85, 0.16]}
RUNE = {"name": "rune", "roughness": 0.4, "emissive": [0.5, 1.7, 3.4]}
BRASS = {"name": "brass", "roughness": 0.3, "metallic": 1, "emissive": [0.25, 0.14, 0.02]}


def wall():
    """Two metres of dry stone, 1.6 m high, along x."""
    m = Mesh(3)
    for row in range(5):
        x = -1.0 - 0.16 * (row % 2)
        while x < 0.95:
            w = 0.26 + 0.24 * m.draw.random()
            left, right = max(x, -1.0), min(x + w, 1.0)
            if right - left > 0.05:
                m.box(((left + right) / 2, 0.14 + 0.285 * row, 0), (right - left - 0.02, 0.27, 0.42 + 0.07 * m.draw.random()),
                      STONE, 0.3, 0.035)
            x += w
    m.box((0, 0.72, 0), (2.0, 1.4, 0.36), (0.12, 0.12, 0.13))
    for i in range(4):
        m.box((-0.75 + 0.5 * i, 1.5, 0), (0.49, 0.16, 0.56), STONE, 0.2, 0.03)
    return [(m, MATTE)]


def rock():
    m = Mesh(9)
    m.blob((0, 0.25, 0), (0.55, 0.42, 0.45), STONE, 0.22, 1, 0.2)
    return [(m, MATTE)]


def hedge():
    """One metre of hedge, 1.1 m high, 0.8 m thick."""
    m = Mesh(4)
    for x, y, z, r in ((-0.3, 0.35, 0.1, 0.42), (0.3, 0.36, -0.1, 0.43), (0, 0.75, 0, 0.42), (-0.28, 0.78, -0.08, 0.33),
                       (0.3, 0.76, 0.1, 0.34)):
        m.blob((x, y, z), (r, r * 0.95, r), LEAF, 0.2, 1, 0.35)
    return [(m, MATTE)]


def bush():
    m = Mesh(12)
    for x, z, r in ((0, 0, 0.42), (0.36, 0.12, 0.3), (-0.3, 0.2, 0.32), (0.05, -0.33, 0.3)):
        m.blob((x, r * 0.8, z), (r, r, r), (0.08, 0.21, 0.09), 0.22, 1, 0.35)
    return [(m, MATTE)]


def tree():
    m = Mesh(21)
    m.tube([(0, 0, 0, 0.26), (0.05, 0.8, 0, 0.17), (-0.06, 1.7, 0.06, 0.14), (0.02, 2.6, 0, 0.09)], BARK, 7)
    m.tube([(0, 1.6, 0, 0.09), (0.55, 2.2, 0.2, 0.06), (0.9, 2.6, 0.3, 0.03)], BARK, 5)
    m.tube([(0, 1.8, 0, 0.08), (-0.5, 2.3, -0.3, 0.05), (-0.8, 2.7, -0.4, 0.03)], BARK, 5)
    for x, y, z, r in ((0, 3.2, 0, 1.0), (0.9, 2.8, 0.3, 0.72), (-0.85, 2.9, -0.4, 0.75), (0.2, 2.7, -0.9, 0.66),
                       (-0.3, 2.75, 0.85, 0.7), (0.1, 3.9, 0.1, 0.62)):
        m.blob((x, y, z), (r, r * 0.78, r), LEAF, 0.16, 1, 0.3)
    return [(m, MATTE)]


def pine():
    m = Mesh(8)
    m.lathe([(0, 0.16), (1.0, 0.12)], BARK, 6)
    for y, r in ((0.6, 1.15), (1.5, 0.92), (2.4, 0.7), (3.2, 0.46)):
        m.lathe([(y, r), (y + 0.35, r * 0.72), (y + 1.3, 0.0)], PINE, 9, play=0.3, turn=y)
    return [(m, MATTE)]


def grass():
    m = Mesh(6)
    for _ in range(9):
        x, z, a = 0.16 * m.draw.random() - 0.08, 0.16 * m.draw.random() - 0.08, TAU * m.draw.random()
        h, lean = 0.14 + 0.16 * m.draw.random(), 0.1 * m.draw.random()
        w = 0.018
        left, right = (x - w * math.cos(a), 0, z - w * math.sin(a)), (x + w * math.cos(a), 0, z + w * math.sin(a))
        top, shade = (x - lean * math.sin(a), h, z + lean * math.cos(a)), m.shade((0.1, 0.24, 0.08), 0.4)
        m.triangle(left, right, top, shade)
        m.triangle(right, left, top, shade)
    return [(m, MATTE)]


def flower():
    m, glow = Mesh(15), Mesh(16)
    for i in range(3):
        x, z, h = 0.1 * math.cos(2.1 * i), 0.1 * math.sin(2.1 * i), 0.16 + 0.05 * i
        m.tube([(x, 0, z, 0.008), (x * 1.3, h, z * 1.3, 0.006)], LEAF, 4)
        glow.lathe([(h, 0.008), (h + 0.03, 0.045), (h + 0.05, 0.02)], (0.5, 0.6, 0.9), 5, (x * 1.3, 0, z * 1.3))
    return [(m, MATTE), (glow, {"name": "petal", "roughness": 0.7, "emissive": [0.07, 0.10, 0.22]})]


def mushroom():
    m, cap = Mesh(17), Mesh(18)
    for x, z, s in ((0, 0, 1.0), (0.13, 0.06, 0.6), (-0.09, 0.1, 0.7)):
        m.lathe([(0, 0.03 * s), (0.14 * s, 0.022 * s)], (0.5, 0.46, 0.4), 6, (x, 0, z))
        cap.lathe([(0.12 * s, 0.1 * s), (0.16 * s, 0.085 * s), (0.2 * s, 0.0)], (0.2, 0.5, 0.6), 8, (x, 0, z))
    return [(m, MATTE), (cap, {"name": "cap", "roughness": 0.5, "emissive": [0.03, 0.22, 0.3]})]


def lantern_cage(m, top, scale=1.0):
    """A lantern that hangs from `top`: roof, floor, four rods; its glass is 0.26 m below."""
    x, y, z = top
    s = scale
    m.lathe([(-0.16 * s, 0.15 * s), (-0.06 * s, 0.07 * s), (-0.0, 0.012 * s)], IRON, 6, (x, y, z), 0.3)
    m.lathe([(-0.40 * s, 0.10 * s), (-0.37 * s, 0.12 * s)], IRON, 6, (x, y, z), 0.3)
    for k in range(4):
        a = TAU * (k + 0.5) / 4
        px, pz = x + 0.1 * s * math.cos(a), z + 0.1 * s * math.sin(a)
        m.tube([(px, y - 0.38 * s, pz, 0.009 * s), (px, y - 0.14 * s, pz, 0.009 * s)], IRON, 4)


def post():
    """A post with an arm from which a lantern hangs: its glass is at (0.42, 1.32, 0)."""
    m = Mesh(30)
    m.lathe([(0, 0.16), (0.12, 0.13), (0.14, 0.06), (1.75, 0.045), (1.85, 0.07), (1.95, 0.0)], IRON, 7, play=0.35)
    m.tube([(0, 1.55, 0, 0.028), (0.2, 1.72, 0, 0.025), (0.42, 1.66, 0, 0.022), (0.42, 1.56, 0, 0.012)], IRON, 5)
    lantern_cage(m, (0.42, 1.58, 0))
    return [(m, MATTE)]


def lantern():
    """A hanging lantern; origin in its glass."""
    m = Mesh(31)
    lantern_cage(m, (0, 0.26, 0))
    return [(m, MATTE)]


def glass():
    m = Mesh(32)
    m.lathe([(-0.1, 0.05), (-0.04, 0.085), (0.04, 0.085), (0.1, 0.05)], (0.9, 0.5, 0.2), 6, play=0.1)
    return [(m, GLOW)]


def ember():
    m = Mesh(33)
    m.blob((0, 0, 0), (1, 1, 1), (1.0, 0.9, 0.5), 0.0, 0)
    return [(m, {"name": "ember", "roughness": 1, "emissive": [3.2, 3.4, 0.8]})]


def key():
    m = Mesh(34)
    m.tube([(0, 0, 0, 0.028), (0, -0.36, 0, 0.028)], GOLD, 7, 0.05)
    ring = [(0.11 * math.sin(TAU * i / 12), 0.11 - 0.11 * math.cos(TAU * i / 12), 0, 0.026) for i in range(13)]
    m.tube(ring, GOLD, 6, 0.05)
    m.box((0.07, -0.33, 0), (0.13, 0.04, 0.035), GOLD, 0.05)
    m.box((0.055, -0.25, 0), (0.1, 0.04, 0.035), GOLD, 0.05)
    return [(m, BRASS)]


def moonstone():
    """A rune stone 1.5 m high."""
    m, rune = Mesh(35), Mesh(36)
    m.lathe([(0, 0.42), (0.3, 0.38), (1.0, 0.30), (1.4, 0.2), (1.55, 0.0)], (0.24, 0.26, 0.31), 5, play=0.2, turn=0.3)
    m.lathe([(0, 1.0), (0.1, 0.95)], STONE, 10, play=0.25)
    for k in range(12):
        a = TAU * k / 12
        rune.box((0.78 * math.cos(a), 0.105, 0.78 * math.sin(a)), (0.16, 0.02, 0.05), (0.4, 0.6, 0.8), 0.1, 0, -a)
    rune.lathe([(1.75, 0.0), (1.87, 0.11), (1.99, 0.0)], (0.5, 0.8, 1.0), 6)
    return [(m, MATTE), (rune, RUNE)]


def arch():
    """A gate of stone, 2.2 m wide inside, along x."""
    m = Mesh(37)
    for side in (-1, 1):
        for i in range(5):
            m.box((side * 1.35, 0.25 + 0.48 * i, 0), (0.52, 0.46, 0.62), STONE, 0.25, 0.03)
        m.box((side * 1.35, 0.06, 0), (0.7, 0.14, 0.8), STONE, 0.1, 0.02)
    for i in range(9):
        a = math.pi * i / 8
        m.box((1.32 * math.cos(a), 2.42 + 0.62 * math.sin(a), 0), (0.46, 0.36, 0.58), STONE, 0.25, 0.05)
    return [(m, MATTE)]


def leaf_of_door():
    """Half of a door, 1.08 m wide from its hinge at x = 0, 2.2 m high; origin at the middle of its foot."""
    m = Mesh(38)
    for i in range(4):
        m.box((-0.405 + 0.27 * i, 1.1, 0), (0.265, 2.2, 0.1), WOOD, 0.3, 0.01)
    for y in (0.4, 1.1, 1.8):
        m.box((0, y, 0), (1.06, 0.1, 0.14), IRON, 0.3)
    m.lathe([(1.08, 0.05), (1.12, 0.05)], GOLD, 6, (0.38, 0, 0.09))
    return [(m, MATTE)]


def plank():
    """A plank of the bridge, 1.3 m long, with its share of the ropes at either end."""
    m, rope = Mesh(39), (0.42, 0.34, 0.2)
    m.box((0, 0, 0), (1.3, 0.06, 0.4), WOOD, 0.35, 0.02)
    for side in (-1, 1):
        m.tube([(side * 0.6, 0.04, -0.25, 0.028), (side * 0.6, 0.04, 0.25, 0.028)], rope, 5)
        m.tube([(side * 0.68, 0.62, -0.26, 0.022), (side * 0.68, 0.62, 0.26, 0.022)], rope, 5)
        m.tube([(side * 0.6, 0.04, 0, 0.014), (side * 0.68, 0.62, 0, 0.014)], rope, 4)
    return [(m, MATTE)]


def stake():
    m = Mesh(40)
    m.lathe([(0, 0.1), (1.0, 0.085), (1.06, 0.11), (1.14, 0.0)], WOOD, 7, play=0.3)
    for y in (0.55, 0.62, 0.69):
        m.lathe([(y, 0.115), (y + 0.05, 0.115)], (0.42, 0.34, 0.2), 7)
    return [(m, MATTE)]


def board():
    """The see-saw's board: 5.2 m along z, 1 m wide, a stone in a bowl on its +z end."""
    m = Mesh(41)
    for i in range(13):
        m.box((0, 0, -2.4 + 0.4 * i), (1.0, 0.08, 0.39), WOOD, 0.3, 0.01)
    for x in (-0.44, 0.44):
        m.box((x, -0.06, 0), (0.08, 0.08, 5.2), BARK)
    return [(m, MATTE)]


def trestle():
    m = Mesh(42)
    for side in (-1, 1):
        m.tube([(side * 0.62, 0, 0.3, 0.07), (side * 0.62, 0.78, 0, 0.06)], BARK, 6)
        m.tube([(side * 0.62, 0, -0.3, 0.07), (side * 0.62, 0.78, 0, 0.06)], BARK, 6)
    m.tube([(-0.72, 0.62, 0, 0.06), (0.72, 0.62, 0, 0.06)], BARK, 7)
    return [(m, MATTE)]


def heart():
    """The great lantern: a stone tower of three roofs, 4.6 m high, its glass at 1.75 m."""
    m = Mesh(43)
    m.lathe([(0, 1.5), (0.18, 1.45), (0.2, 1.15), (0.4, 1.1), (0.42, 0.5), (1.1, 0.4), (1.12, 0.75), (1.25, 0.8)],
            STONE, 8, play=0.25)
    for k in range(8):
        a = TAU * (k + 0.5) / 8
        x, z = 0.66 * math.cos(a), 0.66 * math.sin(a)
        m.tube([(x, 1.2, z, 0.05), (x, 2.3, z, 0.05)], STONE, 5)
    m.lathe([(2.25, 1.15), (2.32, 1.25), (2.7, 0.6), (2.72, 0.42), (3.0, 0.4), (3.02, 0.85), (3.1, 0.9), (3.4, 0.4),
             (3.42, 0.25), (3.65, 0.22), (3.66, 0.5), (3.72, 0.52), (4.1, 0.1), (4.6, 0.0)], (0.2, 0.22, 0.28), 8, play=0.25)
    return [(m, MATTE)]


def lily():
    m = Mesh(44)
    for i in range(9):
        a, b = TAU * i / 10, TAU * (i + 1) / 10
        m.triangle((0, 0, 0), (0.3 * math.cos(b), 0.01, 0.3 * math.sin(b)), (0.3 * math.cos(a), 0.01, 0.3 * math.sin(a)),
                   m.shade((0.06, 0.2, 0.09), 0.3))
    return [(m, MATTE)]


def reed():
    m = Mesh(45)
    for _ in range(7):
        x, z, h = 0.3 * m.draw.random() - 0.15, 0.3 * m.draw.random() - 0.15, 0.8 + 0.6 * m.draw.random()
        m.tube([(x, 0, z, 0.012), (x * 1.5, h, z * 1.5, 0.008)], (0.12, 0.2, 0.08), 4)
        m.tube([(x * 1.5, h, z * 1.5, 0.028), (x * 1.55, h + 0.16, z * 1.55, 0.02)], BARK, 5)
    return [(m, MATTE)]


def on_path(x, z):
    """How much a place belongs to the path, 0 to 1: it winds from the gate to the great lantern."""
    middle = 1.1 * math.sin(0.33 * z) * (0 if -8 < z < 3 else 1)
    rings = min(abs(math.hypot(x, z + 33) - 3.2), abs(math.hypot(x + 4, z - 6) - 1.4))
    return max(0.0, min(1.0, 1.7 - min(abs(x - middle), rings + 0.6)))


def blend(a, b, t):
    return tuple(x + (y - x) * t for x, y in zip(a, b))


def ground_piece(m, x0, x1, z0, z1, y, cell=0.5):
    """Level ground, its corners a little uneven: slabs on the path, grass beside it, earth between."""
    columns, rows = round((x1 - x0) / cell), round((z1 - z0) / cell)
    corner = {}
    for i in range(columns + 1):
        for k in range(rows + 1):
            x, z = x0 + (x1 - x0) * i / columns, z0 + (z1 - z0) * k / rows
            if 0 < i < columns and 0 < k < rows:
                x, z = x + 0.3 * cell * (2 * m.draw.random() - 1), z + 0.3 * cell * (2 * m.draw.random() - 1)
            path = on_path(x, z) + 0.35 * (m.draw.random() - 0.5)
            color = blend(GRASS, EARTH, min(max(3 * path, 0), 1)) if path < 0.4 else blend(EARTH, STONE, min(4 * (path - 0.4), 1))
            corner[i, k] = (x, y, z), m.shade(color, 0.3)
    for i in range(columns):
        for k in range(rows):
            for face in (((i, k), (i, k + 1), (i + 1, k + 1)), ((i, k), (i + 1, k + 1), (i + 1, k))):
                m.position += [corner[c][0] for c in face]
                m.normal += [[0.0, 1.0, 0.0]] * 3
                m.color += [corner[c][1] for c in face]


def ground():
    m = Mesh(50)
    ground_piece(m, -9, 9, 10, 25, 0.0)
    ground_piece(m, -9, 9, 2, 10, 0.9)
    ground_piece(m, -11, 11, -25, -7, 0.9)
    ground_piece(m, -9, 9, -42, -25, 0.9)
    return [(m, {"name": "ground", "roughness": 0.95})]


def cliff():
    """Two metres of rock face, from y = 0 down to -3, that looks along +z."""
    m = Mesh(51)
    rows = [[(-1 + 0.5 * i, -0.75 * k, 0.16 * m.draw.random() - 0.02 if 0 < k else 0.0) for i in range(5)] for k in range(5)]
    for row in rows:
        row[-1] = (1.0, row[0][1], row[0][2])
    for low, high in zip(rows[1:], rows):
        for i in range(4):
            m.quad(low[i], low[i + 1], high[i + 1], high[i], m.shade(STONE, 0.3))
    return [(m, MATTE)]


MODELS = [wall, rock, hedge, bush, tree, pine, grass, flower, mushroom, post, lantern, glass, ember, key, moonstone,
          arch, leaf_of_door, plank, stake, board, trestle, heart, lily, reed, ground, cliff]

# ---- files (layouts: engine/asset/asset.h) ----


def floats(v):
    return struct.pack("<%df" % len(v), *[round(float(x), 5) + 0.0 for x in v])


def write(path, data):
    with open(path, "wb") as f:
        f.write(data)


def write_mesh(path, mesh):
    """Equal corners are stored once."""
    known, order, index = {}, [], []
    for vertex in zip(map(tuple, mesh.position), map(tuple, mesh.normal), mesh.color):
        if vertex not in known:
            known[vertex] = len(order)
            order.append(vertex)
        index.append(known[vertex])
    low = [min(v[0][k] for v in order) for k in range(3)]
    high = [max(v[0][k] for v in order) for k in range(3)]
    data = struct.pack("<4sIIII", b"CMS1", len(order), len(index), 1 | 8, 0) + floats(low + high)  # normal, colour
    for stream in range(3):
        data += b"".join(floats(v[stream]) for v in order)
    write(path, data + struct.pack("<%dI" % len(index), *index))


def write_model(folder, name, parts):
    model = {"materials": [], "meshes": []}
    for i, (mesh, material) in enumerate(parts):
        file = name + ("" if i == 0 else str(i)) + ".cmesh"
        write_mesh(os.path.join(folder, file), mesh)
        model["materials"].append(material)
        model["meshes"].append({"file": file, "material": i})
    write(os.path.join(folder, name + ".cmodel"), (json.dumps(model, indent=2) + "\n").encode())


# ---- the sky ----

MOON = (-0.46, 0.33, -0.78)  # direction, before it is made a unit


def sky(path, width=1024, height=512):
    """Equirectangular, sRGB: a moon with a halo, stars, hills on the horizon. The middle is -Z."""
    draw = random.Random(99)
    length = math.sqrt(sum(c * c for c in MOON))
    moon = [c / length for c in MOON]
    stars = {}
    for _ in range(900):
        x, y = draw.randrange(width), int(height / 2 * draw.random() ** 0.7)
        stars[x, y] = 0.15 + 0.85 * draw.random() ** 5
    rows = bytearray()
    for j in range(height):
        rows.append(0)
        up = math.cos(math.pi * (j + 0.5) / height)
        across = math.sqrt(1 - up * up)
        for i in range(width):
            angle = TAU * ((i + 0.5) / width - 0.5)
            near = math.sin(angle) * across * moon[0] + up * moon[1] - math.cos(angle) * across * moon[2]
            high = max(up, 0.0) ** 0.6
            color = [0.030 - 0.024 * high, 0.050 - 0.038 * high, 0.100 - 0.062 * high]
            halo = math.exp(60 * (near - 1)) * 0.10 + math.exp(9 * (near - 1)) * 0.035
            color = [c + halo * t for c, t in zip(color, (0.75, 0.9, 1.2))]
            star = stars.get((i, j), 0.0) * (1 if up > 0.06 else 0)
            color = [c + 0.7 * star for c in color]
            disc = max(0.0, min(1.0, (near - 0.9979) / 0.0007))  # its edge is two texels wide
            color = [c + (t - c) * disc for c, t in zip(color, (0.95, 0.97, 0.9))]
            hills = 0.05 + 0.025 * math.sin(3 * angle) + 0.012 * math.sin(11 * angle + 1) + 0.006 * math.sin(37 * angle)
            if up < hills:
                color = [0.006, 0.010, 0.016]
            for c in color:
                c = 12.92 * c if c < 0.0031308 else 1.055 * min(c, 1.0) ** (1 / 2.4) - 0.055
                rows.append(int(255 * c + draw.random()) if c < 0.996 else 255)  # dithered: no bands

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    write(path, b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">2I5B", width, height, 8, 2, 0, 0, 0))
          + chunk(b"IDAT", zlib.compress(bytes(rows), 9)) + chunk(b"IEND", b""))


def main():
    out = sys.argv[1] if len(sys.argv) > 1 else os.path.join(os.path.dirname(os.path.abspath(__file__)), "../scripts/game")
    models = os.path.join(out, "models")
    os.makedirs(models, exist_ok=True)
    for make in MODELS:
        write_model(models, make.__name__, make())
    sky(os.path.join(out, "sky.png"))


if __name__ == "__main__":
    main()
