"""Answers known from elsewhere, in double precision: closed forms first, else a fine Runge-Kutta run.

`reference = NAME` in an experiment adds the figures that judge(NAME) derives from a case's parameters
and figures.
"""

import functools
import math


def projectile(params, found):
    """Linear drag k: exact velocity and place (p0 = 0, v0 = (10, 20) m/s)."""
    k, t, g = params.get("k", 1), found["time"], -9.81
    decay, end = math.exp(-k * t), (0.0, g / k)
    x = (10 - end[0]) * (1 - decay) / k
    y = end[1] * t + (20 - end[1]) * (1 - decay) / k
    return {"position_error": math.hypot(found["px"] - x, found["py"] - y)}


def spring(params, found):
    """Undamped oscillator x'' = -k x from (1, 0)."""
    w, t = math.sqrt(params.get("k", 1)), found["time"]
    x, v = math.cos(w * t), -w * math.sin(w * t)
    energy = (found["vx"] ** 2 + w * w * found["px"] ** 2) / (w * w)
    kinetic = abs(found["vx"] ** 2 - v * v) / (w * w)
    return {"position_error": math.hypot(found["px"] - x, (found["vx"] - v) / w),
            "energy_error": abs(energy - 1), "energy_ratio": energy, "kinetic_error": kinetic}


def orbit(params, found):
    """Kepler orbit a = 1, e = 0.5, from the periapsis."""
    mu, a, e, t = params.get("k", 1), 1.0, 0.5, found["time"]
    mean = math.sqrt(mu / a ** 3) * t
    anomaly = mean
    for _ in range(60):
        anomaly -= (anomaly - e * math.sin(anomaly) - mean) / (1 - e * math.cos(anomaly))
    x, y = a * (math.cos(anomaly) - e), a * math.sqrt(1 - e * e) * math.sin(anomaly)
    r = math.hypot(found["px"], found["py"])
    energy = 0.5 * (found["vx"] ** 2 + found["vy"] ** 2) - mu / r
    momentum = found["px"] * found["vy"] - found["py"] * found["vx"]
    phase = math.atan2(found["py"], found["px"]) - math.atan2(y, x)
    return {"position_error": math.hypot(found["px"] - x, found["py"] - y),
            "energy_error": abs(energy + 0.5 * mu) / (0.5 * mu),
            "momentum_error": abs(momentum / math.sqrt(mu * a * (1 - e * e)) - 1),
            "phase_error": abs(math.remainder(phase, 2 * math.pi))}


def rotate(q, v, sign=1):
    x, y, z, w = sign * q[0], sign * q[1], sign * q[2], q[3]
    tx, ty, tz = 2 * (y * v[2] - z * v[1]), 2 * (z * v[0] - x * v[2]), 2 * (x * v[1] - y * v[0])
    return (v[0] + w * tx + y * tz - z * ty, v[1] + w * ty + z * tx - x * tz, v[2] + w * tz + x * ty - y * tx)


def top_attitude(t, inertia, w, steps=20000):
    """Attitude after t of a torque-free body: Runge-Kutta in double with the momentum held."""
    momentum = [i * o for i, o in zip(inertia, w)]

    def rate(q):
        n = math.sqrt(sum(c * c for c in q))
        unit = [c / n for c in q]
        local = rotate(unit, momentum, -1)
        ox, oy, oz = rotate(unit, [m / i for m, i in zip(local, inertia)])
        x, y, z, s = q
        return (0.5 * (ox * s + oy * z - oz * y), 0.5 * (oy * s + oz * x - ox * z),
                0.5 * (oz * s + ox * y - oy * x), -0.5 * (ox * x + oy * y + oz * z))

    q, h = (0.0, 0.0, 0.0, 1.0), t / steps
    for _ in range(steps):
        a = rate(q)
        b = rate([c + 0.5 * h * d for c, d in zip(q, a)])
        c2 = rate([c + 0.5 * h * d for c, d in zip(q, b)])
        d2 = rate([c + h * d for c, d in zip(q, c2)])
        q = [c + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4) for c, k1, k2, k3, k4 in zip(q, a, b, c2, d2)]
    n = math.sqrt(sum(c * c for c in q))
    return [c / n for c in q]


TOPS = {}


def top(params, found):
    """A brick in general motion: angle between the attitudes, drift of spin energy."""
    t = found["time"]
    if t not in TOPS:
        TOPS[t] = top_attitude(t, (0.033333333, 0.086666667, 0.113333333), (2.0, 1.0, 3.0))
    q = [found[k] for k in ("qx", "qy", "qz", "qw")]
    other = TOPS[t] if sum(a * b for a, b in zip(q, TOPS[t])) >= 0 else [-c for c in TOPS[t]]
    half = math.sqrt(sum((a - b) ** 2 for a, b in zip(q, other))) / 2  # chord: exact for small angles too
    return {"position_error": 4 * math.asin(min(1.0, half)), "energy_error": abs(found["spin_energy_ratio"] - 1)}


def motion(params, found):
    """By the case's problem."""
    return {"projectile": projectile, "spring": spring, "orbit": orbit, "top": top}[params["problem"]](params, found)


def grey(text):
    """A square picture from two hexadecimal digits a pixel."""
    import numpy
    values = numpy.frombuffer(bytes.fromhex(text), numpy.uint8).astype(numpy.float32) / 255
    side = math.isqrt(len(values))
    return values.reshape(side, side)


def flip(found):
    """Mean perceived difference of the pictures (Andersson and others, "FLIP", 2020) where the package
    flip-evaluator is in build/venv."""
    try:
        import flip_evaluator
        import numpy
    except ImportError:
        return {}
    want, got = (numpy.repeat(grey(found[k])[:, :, None], 3, axis=2) for k in ("want", "got"))
    return {"flip": float(flip_evaluator.evaluate(want, got, "LDR")[1])}


@functools.cache
def traced_shadow(elevation, source, side):
    """The scene of gfx.shadow by the path tracer Mitsuba, where that package is in build/venv: the share
    of the sun that the ground sees. None without it."""
    try:
        import mitsuba
        import numpy
    except ImportError:
        return None
    mitsuba.set_variant("scalar_rgb")
    place = mitsuba.ScalarTransform4f
    e = math.radians(elevation)
    sun = [-math.cos(e) * math.cos(0.3), math.sin(e), -math.cos(e) * math.sin(0.3)]
    ground = {"type": "diffuse", "reflectance": {"type": "rgb", "value": 1.0}}
    scene = {
        "type": "scene", "integrator": {"type": "direct"},
        "sensor": {"type": "orthographic", "near_clip": 0.1, "far_clip": 100,
                   "to_world": place().look_at(origin=[0, 20, 0], target=[0, 0, 0], up=[0, 0, -1]) @ place().scale([4, 4, 1]),
                   "film": {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}},
                   "sampler": {"type": "multijitter", "sample_count": 144}},
        "sun": {"type": "disk", "emitter": {"type": "area", "radiance": {"type": "rgb", "value": 1.0}},
                "to_world": place().look_at(origin=[1000 * c for c in sun], target=[0, 0, 0], up=[0, 0, 1]) @
                place().scale(1000 * source)},
        "ground": {"type": "rectangle", "to_world": place().rotate([1, 0, 0], -90) @ place().scale(20), "bsdf": ground},
    }
    open_ground = numpy.array(mitsuba.render(mitsuba.load_dict(scene)))[:, :, 0]
    scene["cube"] = {"type": "cube", "to_world": place().translate([-0.6, 0.5, 0.1]) @ place().scale(0.5), "bsdf": ground}
    return numpy.array(mitsuba.render(mitsuba.load_dict(scene)))[:, :, 0] / open_ground


def shadow(params, found):
    """FLIP of the picture, and the rms of the engine's and the rays' visibility from the path tracer's,
    off the cube's edges."""
    figures = flip(found)
    got, want = grey(found["got"]), grey(found["want"])
    traced = traced_shadow(params.get("elevation", 55), params["source"], len(got))
    if traced is not None:
        seen = (want > 0) | (got > 0)
        for name, picture in (("traced_rms", got), ("rays_traced_rms", want)):
            figures[name] = float(((picture - traced)[seen] ** 2).mean() ** 0.5)
    return figures


JUDGES = {"motion": motion, "shadow": shadow}


def judge(name, params, figures):
    """The figures with what the reference adds; broken cases and blown-up states stay as they are."""
    if "broken" in figures:
        return figures
    try:
        return {**figures, **JUDGES[name](params, figures)}
    except (OverflowError, TypeError, ZeroDivisionError, ValueError):
        return {**figures, "position_error": None}
