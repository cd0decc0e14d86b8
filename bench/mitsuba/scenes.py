# SPDX-License-Identifier: MIT OR Apache-2.0
"""The scenes of this folder as Mitsuba 3 knows them: each has a .star file of the same name that says the same."""


def rgb(*values):
    """A colour or radiance, linear."""
    return {"type": "rgb", "value": list(values)}


def matte(*color):
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(*color)}}


def look_at(origin, target, up=(0, 1, 0)):
    import mitsuba as mi

    return mi.ScalarTransform4f().look_at(origin=list(origin), target=list(target), up=list(up))


def camera(origin, target, fov):
    return {
        "type": "perspective",
        "fov": fov,
        "fov_axis": "y",
        "to_world": look_at(origin, target),
    }


def quad(corner, u, v, bsdf, **more):
    """A parallelogram: Mitsuba's rectangle goes from -1 to 1 in x and y."""
    import mitsuba as mi
    import numpy as np

    corner, u, v = (np.array(x, dtype=float) for x in (corner, u, v))
    n = np.cross(u, v)
    n /= np.linalg.norm(n)
    m = np.eye(4)
    m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3] = u / 2, v / 2, n, corner + u / 2 + v / 2
    return {"type": "rectangle", "to_world": mi.ScalarTransform4f(m), "bsdf": bsdf, **more}


def ball(center, radius, bsdf, **more):
    return {"type": "sphere", "center": list(center), "radius": radius, "bsdf": bsdf, **more}


def area(*radiance):
    return {"emitter": {"type": "area", "radiance": rgb(*radiance)}}


def room():
    """The box of Cornell: white but for its left and right walls, a lamp in its ceiling."""
    white, red, green = matte(0.75, 0.75, 0.75), matte(0.63, 0.065, 0.05), matte(0.14, 0.45, 0.091)
    return {
        "floor": quad((-1, -1, 1), (2, 0, 0), (0, 0, -2), white),
        "ceiling": quad((-1, 1, -1), (2, 0, 0), (0, 0, 2), white),
        "back": quad((-1, -1, -1), (2, 0, 0), (0, 2, 0), white),
        "left": quad((-1, -1, 1), (0, 0, -2), (0, 2, 0), red),
        "right": quad((1, -1, -1), (0, 0, 2), (0, 2, 0), green),
        "lamp": quad((-0.25, 0.99, -0.25), (0.5, 0, 0), (0, 0, 0.5), matte(0, 0, 0), **area(18, 15, 10)),
        "shade": quad((-0.25, 0.99005, -0.25), (0.5, 0, 0), (0, 0, 0.5), matte(0, 0, 0)),
        "camera": camera((0, 0, 3.9), (0, 0, 0), 39.3),
    }


def cornell():
    gold = {"type": "conductor", "material": "none", "specular_reflectance": rgb(0.95, 0.75, 0.35)}
    glass = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
    return room() | {
        "gold": ball((-0.4, -0.62, -0.35), 0.38, gold),
        "glass": ball((0.42, -0.65, 0.3), 0.35, glass),
    }


def metals():
    def metal(alpha):
        return {
            "type": "roughconductor", "material": "none", "distribution": "ggx", "alpha": alpha,
            "specular_reflectance": rgb(0.95, 0.75, 0.35),
        }

    alphas = (0.05, 0.1, 0.2, 0.4)
    balls = {
        f"ball{i}": ball((-0.72 + 0.48 * i, -0.76, 0.2), 0.22, metal(a)) for i, a in enumerate(alphas)
    }
    return room() | balls


def frosted():
    def glass(alpha):
        return {
            "type": "roughdielectric", "distribution": "ggx", "alpha": alpha, "int_ior": 1.5, "ext_ior": 1.0,
        }

    return room() | {
        "rough": ball((-0.42, -0.62, -0.2), 0.38, glass(0.3)),
        "finer": ball((0.42, -0.65, 0.3), 0.35, glass(0.1)),
    }


def sky():
    import mitsuba as mi
    import numpy as np

    # The sky of sky.star: a gradient over the height, as a picture that is fine enough. Mitsuba's rows go down.
    rows = 1024
    height = np.cos((np.arange(rows) + 0.5) / rows * np.pi)
    t = np.clip(height, 0, 1)[:, None]
    colors = (1 - t) * np.array([1.0, 0.6, 0.3]) + t * np.array([0.1, 0.25, 0.8])
    picture = np.repeat(colors[:, None, :], 2, axis=1).astype(np.float32)
    return {
        "sky": {"type": "envmap", "bitmap": mi.Bitmap(np.ascontiguousarray(np.repeat(picture, 8, axis=1)))},
        "floor": quad((-8, 0, 8), (16, 0, 0), (0, 0, -16), matte(0.6, 0.6, 0.6)),
        "dull": ball((-1.1, 1, 0), 1, matte(0.7, 0.3, 0.2)),
        "metal": ball(
            (1.1, 1, 0), 1,
            {"type": "conductor", "material": "none", "specular_reflectance": rgb(0.9, 0.9, 0.9)},
        ),
        "camera": camera((0, 2, 7), (0, 0.8, 0), 35),
    }


def lamps():
    import math

    found = {"floor": quad((-6, 0, 6), (12, 0, 0), (0, 0, -12), matte(0.6, 0.6, 0.6))}
    for i in range(64):
        angle, r = 2.399963 * i, 0.6 * math.sqrt(i + 0.5)
        center = (r * math.cos(angle), 0.35, r * math.sin(angle))
        t = i / 63
        found[f"lamp{i}"] = ball(center, 0.06, matte(0, 0, 0), **area(8 * (1 - t) + 1, 5, 8 * t + 1))
    found["ball"] = ball((0, 1.2, 0), 0.8, matte(0.7, 0.7, 0.7))
    found["camera"] = camera((0, 5, 9), (0, 0.5, 0), 40)
    return found


def checker():
    import mitsuba as mi
    import numpy as np

    cells = np.indices((8, 8)).sum(axis=0) % 2
    colors = np.where(cells[:, :, None] == 0, [0.8, 0.75, 0.7], [0.1, 0.2, 0.4]).astype(np.float32)
    texture = {
        "type": "bitmap", "bitmap": mi.Bitmap(colors), "raw": True, "filter_type": "nearest",
    }
    return room() | {
        "floor": quad((-1, -1, 1), (2, 0, 0), (0, 0, -2), {"type": "diffuse", "reflectance": texture}),
        "ball": ball((0, -0.5, 0), 0.5, matte(0.5, 0.5, 0.5)),
    }


def coats():
    def plastic(*color):
        return {
            "type": "plastic", "diffuse_reflectance": rgb(*color), "int_ior": 1.5, "ext_ior": 1.0,
            "nonlinear": True,
        }

    return room() | {
        "red": ball((-0.45, -0.6, -0.3), 0.4, plastic(0.7, 0.1, 0.08)),
        "white": ball((0.42, -0.65, 0.3), 0.35, plastic(0.8, 0.8, 0.8)),
    }


def fog():
    import mitsuba as mi

    def inside(scattering, absorption, g):
        total = [s + a for s, a in zip(scattering, absorption)]
        return {
            "bsdf": {"type": "null"},
            "interior": {
                "type": "homogeneous",
                "sigma_t": rgb(*(t / max(total) for t in total)),
                "scale": max(total),
                "albedo": rgb(*(s / t for s, t in zip(scattering, total))),
                "phase": {"type": "hg", "g": g},
            },
        }

    t = mi.ScalarTransform4f()
    block = t.translate([-0.05, -0.375, -0.15]) @ t.scale([0.75, 0.525, 0.65])
    cloud = inside((8, 8, 8), (0, 0, 0), -0.2)
    return room() | {
        "integrator": {"type": "volpathmis", "max_depth": -1, "rr_depth": 30},
        "block": {"type": "cube", "to_world": block} | inside((0.9, 1.2, 1.2), (0.1, 0.3, 0.8), 0.5),
        "ball": ball((-0.2, -0.5, 0), 0.3, matte(0.75, 0.75, 0.75)),
        "cloud": ball((0.35, 0.5, -0.3), 0.3, **cloud),
    }


SCENES = {f.__name__: f for f in (cornell, metals, frosted, sky, lamps, checker, coats, fog)}
