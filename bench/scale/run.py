#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""How time and memory grow with the scene: from a hundred to ten million spheres and triangles.

    python3 bench/scale/run.py [PLOT.svg]

Needs python3, nothing but its standard library. Makes the scenes, casts the same rays into each with `dioptric trace` on
one thread, prints a Markdown table, and draws it (docs/scale.svg if not said otherwise). DIOPTRIC names the program, MOST
the size of the largest scene (10000000), REPEAT how often the rays are cast (5), WORK a folder for the scenes. Ten million
take about three minutes and 3 GiB of memory.

Spheres lie anywhere in a cube, the more the smaller, so that a ray always meets one after some ten. Triangles are hills
on a square grid. Half of the rays are a camera's, half start anywhere in the cube and go anywhere. Memory is the
most that the program says it had, less what it had for the smallest scene; it includes reading the file.
"""

import array
import math
import os
import random
import struct
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DIOPTRIC = os.environ.get("DIOPTRIC", os.path.join(ROOT, "target/release/dioptric"))
MOST = int(os.environ.get("MOST", "10000000"))
REPEAT = os.environ.get("REPEAT", "5")
RAYS = 1 << 17


def floats(values):
    """Little-endian 32-bit floats."""
    data = array.array("f", values)
    if sys.byteorder == "big":
        data.byteswap()
    return data.tobytes()


def ply(path, vertices, vertex_properties, faces=0):
    """Opens a binary PLY file behind its header."""
    header = f"ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n"
    header += "".join(f"property float {name}\n" for name in vertex_properties)
    if faces:
        header += f"element face {faces}\nproperty list uchar uint vertex_indices\n"
    file = open(path, "wb")
    file.write((header + "end_header\n").encode())
    return file


def write_spheres(path, count):
    """Spheres in the cube from -1 to 1; gives their number."""
    chance = random.Random(1)
    size = 0.6 / count ** (1 / 3)
    with ply(path, count, ["x", "y", "z", "radius"]) as file:
        for start in range(0, count, 100_000):
            values = []
            for _ in range(min(100_000, count - start)):
                values += [2 * chance.random() - 1, 2 * chance.random() - 1, 2 * chance.random() - 1]
                values.append(size * (0.5 + chance.random()))
            file.write(floats(values))
    return count


def write_triangles(path, count):
    """Hills over the square from -1 to 1; gives the number of triangles."""
    n = round(math.sqrt(count / 2))
    with ply(path, (n + 1) ** 2, ["x", "y", "z"], 2 * n * n) as file:
        steps = [2 * i / n - 1 for i in range(n + 1)]
        across = [math.sin(7 * x) + 0.3 * math.sin(31 * x + 1) for x in steps]
        for z, along in zip(steps, across):
            row = []
            for x, height in zip(steps, across):
                row += [x, 0.2 * (height * along), z]
            file.write(floats(row))
        for j in range(n):
            row = []
            for a in range(j * (n + 1), j * (n + 1) + n):
                row += [3, a, a + n + 1, a + n + 2, 3, a, a + n + 2, a + 1]
            file.write(struct.pack("<" + "BIII" * (2 * n), *row))
    return 2 * n * n


def write_rays(path):
    """The rays of a camera, then as many from anywhere to anywhere."""
    chance = random.Random(2)
    values = []
    side = 256
    for i in range(RAYS // 2):
        x, y = (i % side + 0.5) / side - 0.5, 0.5 - (i // side + 0.5) / side
        # Seen from (1.6, 1.1, 2.4): to a point of a screen through the middle of the cube.
        target = [1.6 * x, 1.6 * y, -1.1 * x]
        values += [1.6, 1.1, 2.4, target[0] - 1.6, target[1] - 1.1, target[2] - 2.4]
    for _ in range(RAYS // 2):
        values += [2 * chance.random() - 1 for _ in range(6)]
    with open(path, "wb") as file:
        file.write(floats(values))


def trace(scene, rays):
    """Nanoseconds a ray, seconds of building, and the most bytes that the program had."""
    command = [DIOPTRIC, "trace", scene, rays, "--threads", "1", "--repeat", REPEAT]
    words = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout.replace(",", " ").split()
    rate = float(words[words.index("median") + 1])
    build = float(words[words.index("build") + 1])
    return 1000 / rate, build, int(words[words.index("MB") - 1]) << 20


def measure():
    """One row for each scene: kind, primitives, nanoseconds a ray, bytes and build nanoseconds a primitive."""
    rows = []
    with tempfile.TemporaryDirectory(dir=os.environ.get("WORK")) as folder:
        rays, scene = os.path.join(folder, "rays.bin"), os.path.join(folder, "scene.ply")
        write_rays(rays)
        for kind, write in (("spheres", write_spheres), ("triangles", write_triangles)):
            least = None
            size = 100
            while size <= MOST:
                count = write(scene, size)
                time, build, peak = trace(scene, rays)
                least = least or peak
                rows.append((kind, count, time, (peak - least) / count, build * 1e9 / count))
                size *= 10
    return rows


COLOURS = {"spheres": "#0072b2", "triangles": "#d55e00"}


def panel(rows, column, title, left, first):
    """One diagram: `column` of the rows over their size, from `first` primitives on."""
    width, height, top = 250, 200, 46
    shown = [row for row in rows if row[1] >= first * 0.9]
    least, most = math.log10(min(r[1] for r in shown)), math.log10(max(r[1] for r in shown))
    limit = max(max(r[column] for r in shown), 1) * 1.08
    step = next(s * 10**e for e in range(-3, 9) for s in (1, 2, 5) if limit / (s * 10**e) <= 6)
    x = lambda count: left + (math.log10(count) - least) / max(most - least, 1e-9) * width
    y = lambda value: top + height - value / limit * height
    out = [f'<text x="{left}" y="{top - 16}" font-weight="bold">{title}</text>']
    for i in range(int(limit / step) + 1):
        out.append(f'<path d="M{left} {y(i * step):.1f}h{width}" stroke="#ddd"/>')
        out.append(f'<text x="{left - 6}" y="{y(i * step) + 4:.1f}" text-anchor="end">{i * step:g}</text>')
    for power in range(math.ceil(least - 0.05), math.floor(most + 0.05) + 1):
        at = min(max(x(10**power), left), left + width)
        out.append(f'<text x="{at:.1f}" y="{top + height + 16}" text-anchor="middle">10<tspan dy="-5" font-size="8">'
                   f"{power}</tspan></text>")
    for kind, colour in COLOURS.items():
        points = [(x(r[1]), y(r[column])) for r in shown if r[0] == kind]
        line = " ".join(f"{a:.1f},{b:.1f}" for a, b in points)
        out.append(f'<polyline points="{line}" fill="none" stroke="{colour}" stroke-width="2"/>')
        out += [f'<circle cx="{a:.1f}" cy="{b:.1f}" r="3" fill="{colour}"/>' for a, b in points]
    return out


def draw(rows, path):
    """Writes the plot."""
    most = max(row[1] for row in rows)
    later = min(100_000, most)
    out = ['<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 960 310" font-family="sans-serif" font-size="11">',
           "<title>Cost as the scene grows</title>", '<rect width="960" height="310" fill="white"/>']
    out += panel(rows, 2, "nanoseconds a ray, one thread", 50, 100)
    out += panel(rows, 3, "bytes a primitive, all included", 370, later)
    out += panel(rows, 4, "nanoseconds of building a primitive", 690, later)
    for left, (kind, colour) in zip((380, 480), COLOURS.items()):
        out.append(f'<circle cx="{left}" cy="292" r="4" fill="{colour}"/><text x="{left + 9}" y="296">{kind}</text>')
    with open(path, "w") as file:
        file.write("\n".join(out + ["</svg>", ""]))


def main():
    plot = sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "docs/scale.svg")
    if not os.access(DIOPTRIC, os.X_OK):
        subprocess.run(["cargo", "build", "--release"], cwd=ROOT, check=True)
    rows = measure()
    print("| primitives | | ns a ray, one thread | bytes a primitive | build, ns a primitive |")
    print("|---|---|---|---|---|")
    for kind, count, time, memory, build in rows:
        memory = f"{memory:.0f}" if count >= 90_000 else ""
        print(f"| {count} | {kind} | {time:.0f} | {memory} | {build:.0f} |")
    draw(rows, plot)


main()
