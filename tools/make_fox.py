#!/usr/bin/env python3
"""Makes the fox: assets/models/fox.{cmodel,cmesh,cskel} and fox_CLIP.canim.

A skinned fox of lofted tubes, 1 m from nose to tail tip, facing +Z, standing on y = 0, and six
clips in place: idle, walk, run, jump, turn, hit. Legs follow paths of the paws by two-bone inverse
kinematics in the leg's plane, so that a standing paw stays where it is. Numbers are rounded to
1e-6 before they are written: the files do not depend on the last bits of the C library.

    tools/make_fox.py [OUT_DIR]          (default assets/models)
"""
import json
import math
import os
import struct
import sys

ORANGE, WHITE, DARK = (0.80, 0.30, 0.07), (0.92, 0.88, 0.80), (0.10, 0.07, 0.06)

# name, parent, position in model space (m). Legs: shoulder or hip, elbow or knee, paw.
BONES = [
    ("root", None, (0, 0, 0)),
    ("hips", "root", (0, 0.34, -0.16)),
    ("spine", "hips", (0, 0.35, -0.02)),
    ("chest", "spine", (0, 0.35, 0.12)),
    ("neck", "chest", (0, 0.39, 0.21)),
    ("head", "neck", (0, 0.48, 0.28)),
    ("ear_l", "head", (0.035, 0.53, 0.275)),
    ("ear_r", "head", (-0.035, 0.53, 0.275)),
    ("tail1", "hips", (0, 0.35, -0.23)),
    ("tail2", "tail1", (0, 0.33, -0.32)),
    ("tail3", "tail2", (0, 0.30, -0.41)),
    ("tail4", "tail3", (0, 0.28, -0.50)),
]
for side, x in (("l", 0.06), ("r", -0.06)):
    BONES += [
        ("front_upper_" + side, "chest", (x, 0.30, 0.14)),
        ("front_lower_" + side, "front_upper_" + side, (x, 0.17, 0.115)),
        ("front_paw_" + side, "front_lower_" + side, (x, 0.035, 0.14)),
        ("hind_upper_" + side, "hips", (x, 0.30, -0.17)),
        ("hind_lower_" + side, "hind_upper_" + side, (x, 0.17, -0.135)),
        ("hind_paw_" + side, "hind_lower_" + side, (x, 0.035, -0.19)),
    ]
INDEX = {name: i for i, (name, _, _) in enumerate(BONES)}
PARENT = [INDEX[p] if p else -1 for _, p, _ in BONES]
PLACE = [p for _, _, p in BONES]


def rounded(v):
    return [round(float(x), 6) + 0.0 for x in v]


def sub(a, b):
    return tuple(x - y for x, y in zip(a, b))


LOCAL = [PLACE[i] if PARENT[i] < 0 else sub(PLACE[i], PLACE[PARENT[i]]) for i in range(len(BONES))]

# ---- mesh: tubes of rings; a ring is (centre, half width, half height, colour, bone weights) ----


class Mesh:
    def __init__(self):
        self.position, self.normal, self.color, self.joint, self.weight, self.index = (
            [], [], [], [], [], [])

    def vertex(self, p, color, weights):
        pairs = sorted(weights.items(), key=lambda w: (-w[1], w[0]))[:4]
        total = sum(w for _, w in pairs)
        pairs += [(INDEX["root"], 0.0)] * (4 - len(pairs))
        self.position.append(p)
        self.color.append(tuple(color) + (1.0,))
        self.joint.append([b for b, _ in pairs])
        self.weight.append([w / total for _, w in pairs])
        return len(self.position) - 1

    def tube(self, rings, sides=10):
        """Rings across the line through their centres, closed at both ends."""
        rows = []
        for i, (c, half_x, half_y, color, weights) in enumerate(rings):
            a, b = rings[max(i - 1, 0)][0], rings[min(i + 1, len(rings) - 1)][0]
            along = sub(b, a)
            length = math.hypot(along[1], along[2])
            up = (0, along[2] / length, -along[1] / length)  # across the line, in its plane
            row = []
            for k in range(sides):
                t = 2 * math.pi * k / sides
                u, v = half_x * math.cos(t), half_y * math.sin(t)
                p = (c[0] + u, c[1] + up[1] * v, c[2] + up[2] * v)
                below = math.sin(t) < -0.5 and color == ORANGE
                row.append(self.vertex(p, WHITE if below else color, weights))
            rows.append(row)
        forward = rings[-1][0][2] > rings[0][0][2] or (
            rings[-1][0][2] == rings[0][0][2] and rings[-1][0][1] < rings[0][0][1])
        for low, high in zip(rows, rows[1:]):
            for k in range(sides):
                n = (k + 1) % sides
                self.quad(low[k], low[n], high[n], high[k], forward)
        for row, (c, _, _, color, weights), first in ((rows[0], rings[0], True),
                                                      (rows[-1], rings[-1], False)):
            middle = self.vertex(c, color, weights)
            for k in range(sides):
                n = (k + 1) % sides
                self.triangle(middle, row[n], row[k], forward == first)

    def quad(self, a, b, c, d, keep):
        self.triangle(a, b, c, keep)
        self.triangle(a, c, d, keep)

    def triangle(self, a, b, c, keep):
        self.index += (a, b, c) if keep else (a, c, b)

    def finish(self):
        """Smooth normals: area-weighted over the triangles at each vertex."""
        sums = [[0.0, 0.0, 0.0] for _ in self.position]
        for i in range(0, len(self.index), 3):
            a, b, c = (self.position[v] for v in self.index[i:i + 3])
            u, v = sub(b, a), sub(c, a)
            n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
            for vertex in self.index[i:i + 3]:
                for k in range(3):
                    sums[vertex][k] += n[k]
        for n in sums:
            length = math.sqrt(sum(x * x for x in n)) or 1.0
            self.normal.append([x / length for x in n])


def chain(names, t):
    """Weights along a chain of bones: t = 1.5 is half of the second and half of the third."""
    i = min(int(t), len(names) - 1)
    f = t - i if i + 1 < len(names) else 0.0
    weights = {INDEX[names[i]]: 1.0 - f}
    if f > 0:
        weights[INDEX[names[i + 1]]] = f
    return weights


def body(mesh):
    spine = ["hips", "spine", "chest", "neck", "head"]
    rows = [((0, 0.335, -0.245), 0.030, 0.035, 0), ((0, 0.335, -0.215), 0.062, 0.070, 0),
            ((0, 0.335, -0.15), 0.078, 0.088, 0), ((0, 0.335, -0.08), 0.074, 0.082, 0.5),
            ((0, 0.335, 0.0), 0.072, 0.082, 1.1), ((0, 0.335, 0.08), 0.078, 0.092, 1.7),
            ((0, 0.345, 0.15), 0.076, 0.094, 2.1), ((0, 0.385, 0.21), 0.058, 0.070, 2.8),
            ((0, 0.440, 0.245), 0.048, 0.054, 3.4)]
    mesh.tube([(c, x, y, ORANGE, chain(spine, t)) for c, x, y, t in rows], 12)
    head = {INDEX["head"]: 1.0}
    rows = [((0, 0.495, 0.215), 0.020, 0.020, ORANGE), ((0, 0.497, 0.235), 0.056, 0.048, ORANGE),
            ((0, 0.495, 0.270), 0.068, 0.056, ORANGE), ((0, 0.485, 0.310), 0.052, 0.044, ORANGE),
            ((0, 0.470, 0.345), 0.026, 0.026, ORANGE), ((0, 0.462, 0.385), 0.017, 0.017, ORANGE),
            ((0, 0.462, 0.398), 0.010, 0.010, DARK)]
    mesh.tube([(c, x, y, color, head) for c, x, y, color in rows], 12)


def ears(mesh):
    for side, x in (("ear_l", 0.035), ("ear_r", -0.035)):
        w = {INDEX[side]: 1.0}
        base = {INDEX[side]: 0.5, INDEX["head"]: 0.5}
        mesh.tube([((x, 0.525, 0.272), 0.024, 0.012, ORANGE, base),
                   ((x * 1.2, 0.565, 0.270), 0.017, 0.009, ORANGE, w),
                   ((x * 1.45, 0.625, 0.266), 0.003, 0.003, DARK, w)], 6)


def tail(mesh):
    bones = ["hips", "tail1", "tail2", "tail3", "tail4"]
    rows = [((0, 0.350, -0.21), 0.022, 0.022, ORANGE, 0.4), ((0, 0.345, -0.26), 0.030, 0.030, ORANGE, 1.2),
            ((0, 0.330, -0.32), 0.046, 0.046, ORANGE, 1.9), ((0, 0.312, -0.38), 0.058, 0.058, ORANGE, 2.5),
            ((0, 0.298, -0.43), 0.060, 0.060, ORANGE, 3.1), ((0, 0.285, -0.49), 0.050, 0.050, WHITE, 3.8),
            ((0, 0.275, -0.55), 0.028, 0.028, WHITE, 4.0), ((0, 0.272, -0.585), 0.006, 0.006, WHITE, 4.0)]
    mesh.tube([(c, x, y, color, chain(bones, t)) for c, x, y, color, t in rows], 10)


def legs(mesh):
    for end, trunk, knee_z in (("front", "chest", 0.115), ("hind", "hips", -0.135)):
        for side, x in (("l", 0.06), ("r", -0.06)):
            bones = [trunk] + ["%s_%s_%s" % (end, part, side) for part in ("upper", "lower", "paw")]
            top, paw = PLACE[INDEX[bones[1]]], PLACE[INDEX[bones[3]]]
            thick = 0.036 if end == "hind" else 0.028
            rows = [((x, top[1] + 0.02, top[2]), thick * 0.8, thick * 1.1, ORANGE, 0.6),
                    ((x, top[1] - 0.05, top[2]), thick, thick * 1.2, ORANGE, 1.0),
                    ((x, 0.19, knee_z), 0.021, 0.024, ORANGE, 1.6),
                    ((x, 0.15, knee_z), 0.018, 0.020, ORANGE, 2.0),
                    ((x, 0.08, (knee_z + paw[2]) / 2), 0.014, 0.015, DARK, 2.2),
                    ((x, 0.040, paw[2]), 0.016, 0.017, DARK, 2.9)]
            mesh.tube([(c, u, v, color, chain(bones, t)) for c, u, v, color, t in rows], 8)
            w = {INDEX[bones[3]]: 1.0}
            mesh.tube([((x, 0.018, paw[2] - 0.016), 0.016, 0.016, DARK, w),
                       ((x, 0.019, paw[2] + 0.005), 0.021, 0.019, DARK, w),
                       ((x, 0.015, paw[2] + 0.038), 0.017, 0.014, DARK, w)], 8)


# ---- motion ----


def quat(axis, angle):
    s = math.sin(angle / 2)
    return (axis[0] * s, axis[1] * s, axis[2] * s, math.cos(angle / 2))


def multiply(a, b):
    ax, ay, az, aw = a
    bx, by, bz, bw = b
    return (aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz)


X, Y, Z = (1, 0, 0), (0, 1, 0), (0, 0, 1)


class Pose:
    def __init__(self):
        self.move = {}
        self.turn = {}

    def rotate(self, bone, axis, angle):
        self.turn[bone] = multiply(self.turn.get(bone, (0, 0, 0, 1)), quat(axis, angle))

    def shift(self, bone, d):
        self.move[bone] = tuple(a + b for a, b in zip(self.move.get(bone, (0, 0, 0)), d))


def plane_angle(v):
    """Angle of a vector in the y-z plane from straight down, positive when a turn about +X has
    swung it backwards (to -z)."""
    return math.atan2(-v[2], -v[1])


def leg(pose, end, side, paw_y, paw_z, trunk_pitch=0.0, trunk_y=0.0, trunk_z=0.0):
    """Puts a paw paw_y above and paw_z before its standing place by bending hip and knee."""
    names = ["%s_%s_%s" % (end, part, side) for part in ("upper", "lower", "paw")]
    hip, knee, paw = (PLACE[INDEX[n]] for n in names)
    a = math.hypot(knee[1] - hip[1], knee[2] - hip[2])
    b = math.hypot(paw[1] - knee[1], paw[2] - knee[2])
    target = (0, paw[1] + paw_y - hip[1] - trunk_y, paw[2] + paw_z - hip[2] - trunk_z)
    d = min(max(math.hypot(target[1], target[2]), abs(a - b) + 1e-4), (a + b) * 0.9995)
    forward = -1 if end == "front" else 1  # elbows point back, knees forward
    inside = math.acos(max(-1, min(1, (a * a + d * d - b * b) / (2 * a * d))))
    direction = plane_angle(target)
    upper = direction - forward * inside
    knee_y, knee_z = -a * math.cos(upper), -a * math.sin(upper)
    lower = plane_angle((0, target[1] * d / math.hypot(target[1], target[2]) - knee_y,
                         target[2] * d / math.hypot(target[1], target[2]) - knee_z))
    rest_upper, rest_lower = plane_angle(sub(knee, hip)), plane_angle(sub(paw, knee))
    swing = upper - rest_upper
    bend = lower - rest_lower - swing
    pose.rotate(names[0], X, swing - trunk_pitch)
    pose.rotate(names[1], X, bend)
    pose.rotate(names[2], X, -swing - bend)


def cycle(phase, stride, lift, duty):
    """Path of a paw: on the ground from +stride/2 to -stride/2 for `duty` of the cycle, then back in
    an arc."""
    phase %= 1.0
    if phase < duty:
        return 0.0, stride * (0.5 - phase / duty)
    t = (phase - duty) / (1 - duty)
    smooth = t * t * (3 - 2 * t)
    return lift * math.sin(math.pi * t), stride * (smooth - 0.5)


def sway_tail(pose, phase, amount, up=0.0):
    for i, bone in enumerate(("tail1", "tail2", "tail3", "tail4")):
        pose.rotate(bone, Y, amount * math.sin(2 * math.pi * phase - 0.9 * i))
        pose.rotate(bone, X, up)


def idle(u):
    p = Pose()
    breath = math.sin(2 * math.pi * u * 2)
    p.shift("hips", (0, 0.003 * breath, 0))
    p.rotate("chest", X, 0.02 * breath)
    p.rotate("neck", X, -0.02 * breath)
    p.rotate("head", Y, 0.35 * math.sin(2 * math.pi * u) * abs(math.sin(math.pi * u)))
    flick = max(0.0, math.sin(2 * math.pi * (u * 4 % 1.0))) if 0.55 < u < 0.8 else 0.0
    p.rotate("ear_l", Z, -0.5 * flick)
    sway_tail(p, u, 0.16)
    for side in "lr":
        leg(p, "front", side, 0, 0, 0.0, 0.003 * breath)
        leg(p, "hind", side, 0, 0, 0.0, 0.003 * breath)
    return p


def gait(u, stride, lift, duty, phases, bounce, pitch, head):
    p = Pose()
    y = bounce * math.cos(4 * math.pi * u) if pitch == 0 else bounce * math.cos(2 * math.pi * u)
    tilt = pitch * math.sin(2 * math.pi * u)
    p.shift("hips", (0, y, 0))
    p.rotate("hips", X, tilt)
    p.rotate("spine", X, -2 * tilt)
    p.rotate("chest", X, tilt)
    p.rotate("neck", X, head)
    p.rotate("head", X, -head)
    sway_tail(p, u, 0.10, 0.05)
    for (end, side), phase in phases.items():
        paw_y, paw_z = cycle(u + phase, stride, lift, duty)
        leg(p, end, side, paw_y, paw_z, tilt if end == "hind" else 0.0, y)
    return p


def walk(u):  # lateral sequence: each paw a quarter after the one before
    phases = {("hind", "l"): 0.0, ("front", "l"): 0.75, ("hind", "r"): 0.5, ("front", "r"): 0.25}
    return gait(u, 0.22, 0.045, 0.65, phases, 0.005, 0.0, 0.06 * math.sin(4 * math.pi * u))


def run(u):  # gallop: both hind paws, then both front paws
    phases = {("hind", "l"): 0.0, ("hind", "r"): 0.90, ("front", "l"): 0.52, ("front", "r"): 0.42}
    return gait(u, 0.34, 0.075, 0.38, phases, 0.014, 0.16, 0.10)


def ramp(u, a, b):
    t = min(max((u - a) / (b - a), 0.0), 1.0)
    return t * t * (3 - 2 * t)


def jump(u):
    p = Pose()
    crouch = ramp(u, 0, 0.2) - ramp(u, 0.2, 0.35) + ramp(u, 0.75, 0.85) - ramp(u, 0.85, 1)
    flight = min(max((u - 0.3) / 0.5, 0.0), 1.0)
    y = 0.30 * 4 * flight * (1 - flight) - 0.06 * crouch
    tilt = 0.35 * math.sin(2 * math.pi * flight)
    p.shift("hips", (0, y, 0))
    p.rotate("hips", X, -tilt)
    p.rotate("head", X, tilt * 0.6)
    sway_tail(p, u, 0.05, -0.25 * math.sin(math.pi * flight))
    tuck = 0.07 * math.sin(math.pi * flight)
    for side in "lr":
        for end, sign in (("front", 1), ("hind", -1)):
            air = y + 0.06 * crouch
            leg(p, end, side, air + tuck, sign * tuck, 0.0, y)
    return p


def turn(u):  # stepping round on the spot, to the left: the root is turned by the game
    phases = {("hind", "l"): 0.0, ("front", "r"): 0.0, ("hind", "r"): 0.5, ("front", "l"): 0.5}
    p = Pose()
    bend = 0.16 * math.sin(math.pi * u) ** 2
    for bone in ("spine", "chest", "neck", "head"):
        p.rotate(bone, Y, bend)
    sway_tail(p, u, 0.22)
    for (end, side), phase in phases.items():
        paw_y, _ = cycle(u * 2 + phase, 0.0, 0.03, 0.5)
        leg(p, end, side, paw_y, 0.0)
    return p


def hit(u):
    p = Pose()
    shock = math.sin(math.pi * min(u * 2.5, 1.0)) * (1 - u) + 0.0
    p.shift("hips", (0.02 * shock, -0.03 * shock, -0.02 * shock))
    p.rotate("spine", Y, -0.35 * shock)
    p.rotate("neck", Z, 0.40 * shock)
    p.rotate("head", X, 0.45 * shock)
    for ear in ("ear_l", "ear_r"):
        p.rotate(ear, X, -0.8 * shock)
    sway_tail(p, u, 0.3 * shock)
    for side in "lr":
        leg(p, "front", side, 0, 0, 0.0, -0.03 * shock, -0.02 * shock)
        leg(p, "hind", side, 0, 0, 0.0, -0.03 * shock, -0.02 * shock)
    return p


# name, seconds, keys, function of the place in the clip
CLIPS = [("idle", 2.0, 31, idle), ("walk", 0.8, 25, walk), ("run", 0.44, 21, run),
         ("jump", 0.9, 28, jump), ("turn", 0.8, 25, turn), ("hit", 0.5, 16, hit)]

# ---- files (layouts: engine/asset/asset.h) ----


def name128(text):
    return text.encode().ljust(128, b"\0")


def floats(v):
    v = rounded(v)
    return struct.pack("<%df" % len(v), *v)


def write_skeleton(path):
    data = struct.pack("<4sI", b"CSK1", len(BONES))
    for i, (name, _, place) in enumerate(BONES):
        data += name128(name) + struct.pack("<i", PARENT[i])
        data += floats(LOCAL[i]) + floats((0, 0, 0, 1)) + floats((1, 1, 1))
        data += floats((1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0) + tuple(-x for x in place) + (1,))
    write(path, data)


def write_mesh(path, mesh):
    low = [min(p[k] for p in mesh.position) for k in range(3)]
    high = [max(p[k] for p in mesh.position) for k in range(3)]
    flags = 1 | 8 | 16  # normal, colour, skin
    data = struct.pack("<4sIIII", b"CMS1", len(mesh.position), len(mesh.index), flags, len(BONES))
    data += floats(low + high)
    for stream in (mesh.position, mesh.normal, mesh.color):
        data += b"".join(floats(v) for v in stream)
    data += b"".join(struct.pack("<4H", *v) for v in mesh.joint)
    data += b"".join(floats(v) for v in mesh.weight)
    data += struct.pack("<%dI" % len(mesh.index), *mesh.index)
    write(path, data)


def write_clip(path, name, duration, keys, motion):
    poses = [motion(k / (keys - 1)) for k in range(keys)]
    moved = [i for i, (bone, _, _) in enumerate(BONES)
             if any(bone in p.turn or bone in p.move for p in poses)]
    data = b"CAN1" + name128(name) + struct.pack("<fII", duration, len(BONES), len(moved))
    for i in moved:
        bone = BONES[i][0]
        data += struct.pack("<II", i, keys)
        for k, p in enumerate(poses):
            place = [a + b for a, b in zip(LOCAL[i], p.move.get(bone, (0, 0, 0)))]
            data += floats([duration * k / (keys - 1)] + place)
            data += floats(p.turn.get(bone, (0, 0, 0, 1))) + floats((1, 1, 1))
    write(path, data)


def write(path, data):
    with open(path, "wb") as f:
        f.write(data)


def main():
    out = sys.argv[1] if len(sys.argv) > 1 else os.path.join(
        os.path.dirname(os.path.abspath(__file__)), "..", "assets", "models")
    os.makedirs(out, exist_ok=True)
    mesh = Mesh()
    for part in (body, ears, tail, legs):
        part(mesh)
    mesh.finish()
    write_mesh(os.path.join(out, "fox.cmesh"), mesh)
    write_skeleton(os.path.join(out, "fox.cskel"))
    for name, duration, keys, motion in CLIPS:
        write_clip(os.path.join(out, "fox_%s.canim" % name), name, duration, keys, motion)
    model = {
        "skeleton": "fox.cskel",
        "materials": [{"name": "fur", "baseColor": [1, 1, 1, 1], "metallic": 0, "roughness": 0.8}],
        "meshes": [{"file": "fox.cmesh", "material": 0, "skinned": True}],
        "clips": [{"name": n, "file": "fox_%s.canim" % n} for n, _, _, _ in CLIPS],
    }
    write(os.path.join(out, "fox.cmodel"), (json.dumps(model, indent=2) + "\n").encode())


if __name__ == "__main__":
    main()
