#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Renders the scenes of this folder by paths, with Dioptric and with Mitsuba 3, and compares them.

    bench/mitsuba/run.py agree [SCENE ...]    do the mean pictures agree?
    bench/mitsuba/run.py error [SCENE ...]    seconds and error at 16, 64 and 256 samples
    bench/mitsuba/run.py keep [SCENE ...]     only the long references of `error`, into the folder KEEP

Prints Markdown tables. Needs Python 3 with `pip install mitsuba numpy`. DIOPTRIC names the program, SEEDS how many
pictures of each program a mean is made of (8), SAMPLES their samples (256), SIZE their side (128); for `error` THREADS (2),
REFERENCE the samples of the reference (16384), ROUNDS how often each picture is made, in turn (3), VARIANTS which Mitsuba
("llvm_ad_rgb scalar_rgb"), CYCLES a Python with `bpy` (none: without Cycles; it renders cornell, metals, checker and sky
only). The llvm ones need LLVM 16 or newer; DRJIT_LIBLLVM_PATH names it. PLOT names a file for a log-log plot (SVG).
KEEP names a folder that long references are kept in, and taken from where they lie there.

`agree` cuts the pictures into 8 x 8 blocks. For each block, Welch's t-test asks whether the two means are those of one
distribution; 1 % of the blocks should be beyond the limit of 1 %.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

import mitsuba as mi
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
DIOPTRIC = os.environ.get("DIOPTRIC", str(HERE.parent.parent / "target/release/dioptric"))
SEEDS = int(os.environ.get("SEEDS", 8))
SAMPLES = int(os.environ.get("SAMPLES", 256))
THREADS = int(os.environ.get("THREADS", 2))
ROUNDS = int(os.environ.get("ROUNDS", 3))
REFERENCE = int(os.environ.get("REFERENCE", 16384))
VARIANTS = os.environ.get("VARIANTS", "llvm_ad_rgb scalar_rgb").split()
DEPTH = 12  # edges of a path, as Mitsuba counts: 10 bounces


def ours(scene, size, samples, seed, threads=THREADS):
    """A picture by Dioptric and its render seconds."""
    with tempfile.TemporaryDirectory() as folder:
        picture, stats = f"{folder}/x.exr", f"{folder}/x.json"
        subprocess.run(
            [DIOPTRIC, "render", HERE / f"{scene}.star", "--size", f"{size}x{size}", "--samples", str(samples),
             "--seed", str(seed), "--threads", str(threads), "--quiet", "-o", picture, "--stats", stats],
            check=True,
        )
        pixels = np.array(mi.Bitmap(picture).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))
        return pixels, json.loads(pathlib.Path(stats).read_text())["seconds"]["render"]


class Theirs:
    """A scene in Mitsuba."""

    def __init__(self, scene, size, variant):
        mi.set_variant(variant)
        from scenes import SCENES

        self.variant, self.size = variant, size
        parts = SCENES[scene]()
        parts["camera"] |= {
            "film": {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}, "pixel_format": "rgb"},
            "sampler": {"type": "independent"},
        }
        self.scene = mi.load_dict({"type": "scene", "integrator": {"type": "path", "max_depth": DEPTH}} | parts)

    def render(self, samples, seed):
        mi.set_variant(self.variant)
        start = time.perf_counter()
        pixels = np.array(mi.render(self.scene, spp=samples, seed=seed))
        return pixels, time.perf_counter() - start


def plain(parts):
    """A scene of Mitsuba's, told in numbers and names alone, for Cycles; None where it has something else."""

    def matter(part):
        if "emitter" in part:
            return {"type": "glow", "radiance": part["emitter"]["radiance"]["value"]}
        bsdf = part["bsdf"]
        bsdf = bsdf.get("bsdf", bsdf)
        kind = bsdf["type"]
        told = {"type": kind.removeprefix("rough"), "alpha": bsdf.get("alpha", 0.0)}
        if kind == "diffuse":
            reflectance = bsdf["reflectance"]
            if reflectance["type"] == "rgb":
                return told | {"color": reflectance["value"]}
            return told | {"texture": np.array(reflectance["bitmap"]).tolist()}
        if told["type"] == "conductor":
            return told | {"color": bsdf["specular_reflectance"]["value"]}
        return told | {"ior": bsdf["int_ior"]} if told["type"] == "dielectric" else None

    told = {"bounces": DEPTH - 2, "things": []}
    for name, part in parts.items():
        if name == "camera":
            m = np.array(part["to_world"].matrix)
            eye, ahead, up = (m[:3, i].tolist() for i in (3, 2, 1))
            told["camera"] = {"eye": eye, "ahead": ahead, "up": up, "fov": part["fov"]}
        elif name == "sky":
            told["sky"] = ((1.0, 0.6, 0.3), (0.1, 0.25, 0.8))
        else:
            material = matter(part)
            if material is None or name.startswith("lamp") and part["type"] == "sphere":
                return None
            if part["type"] == "sphere":
                told["things"].append({"shape": "ball", "center": part["center"], "radius": part["radius"], "material": material})
            else:
                m = np.array(part["to_world"].matrix)
                u, v = 2 * m[:3, 0], 2 * m[:3, 1]
                corner = m[:3, 3] - (u + v) / 2
                told["things"].append(
                    {"shape": "quad", "corner": corner.tolist(), "u": u.tolist(), "v": v.tolist(), "material": material}
                )
    return told


class Cycles:
    """A scene in Cycles, which runs in a process of its own."""

    def __init__(self, told, size):
        self.size, self.folder = size, tempfile.TemporaryDirectory()
        self.process = subprocess.Popen(
            [os.environ["CYCLES"], HERE / "blender.py"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self.ask({"scene": told})
        self.render(1, 0)  # it builds its tree with the first picture

    def ask(self, request):
        self.process.stdin.write(json.dumps(request) + "\n")
        self.process.stdin.flush()
        for line in self.process.stdout:
            if line.startswith("cycles "):
                return float(line.split()[1])
        raise RuntimeError("Cycles has ended")

    def render(self, samples, seed):
        output = f"{self.folder.name}/x.exr"
        seconds = self.ask({"size": self.size, "samples": samples, "seed": seed, "threads": THREADS, "output": output})
        return np.array(mi.Bitmap(output).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False)), seconds

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def blocks(pictures, side=8):
    """Means of blocks, an axis for the pictures first."""
    n, height, width, lanes = pictures.shape
    return pictures.reshape(n, height // side, side, width // side, side, lanes).mean(axis=(2, 4))


def agree(names):
    size = int(os.environ.get("SIZE", 128))
    print("| scene | mean of Dioptric | of Mitsuba | difference, % | its standard error, % | blocks beyond 1 %, % |")
    print("|---|---|---|---|---|---|")
    for name in names:
        theirs = Theirs(name, size, VARIANTS[0])
        a = np.stack([ours(name, size, SAMPLES, seed)[0] for seed in range(SEEDS)])
        b = np.stack([theirs.render(SAMPLES, 1000 + seed)[0] for seed in range(SEEDS)])
        mean_a, mean_b = a.mean(), b.mean()
        error = np.sqrt((a.mean(axis=(1, 2, 3)).var(ddof=1) + b.mean(axis=(1, 2, 3)).var(ddof=1)) / SEEDS)
        block_a, block_b = blocks(a), blocks(b)
        va, vb = block_a.var(axis=0, ddof=1) / SEEDS, block_b.var(axis=0, ddof=1) / SEEDS
        # What hardly varies at all is compared to a ten-thousandth, not to its noise.
        va, vb = (v + (1e-4 * mean_b) ** 2 for v in (va, vb))
        t = (block_a.mean(axis=0) - block_b.mean(axis=0)) / np.sqrt(np.maximum(va + vb, 1e-30))
        freedom = (va + vb) ** 2 / np.maximum((va**2 + vb**2) / (SEEDS - 1), 1e-60)
        # Student's t as a normal number (Wallace 1959): good to a few per cent of the tail.
        z = np.sqrt(freedom * np.log1p(t * t / freedom)) * (8 * freedom + 1) / (8 * freedom + 3)
        beyond = 100 * np.mean(z > 2.5758)
        print(
            f"| {name} | {mean_a:.5f} | {mean_b:.5f} | {100 * (mean_a / mean_b - 1):+.3f} | {100 * error / mean_b:.3f}"
            f" | {beyond:.1f} |",
            flush=True,
        )


def trimmed(square):
    """The root of the mean without the worst hundredth of the pixels."""
    flat = np.sort(square.mean(axis=2).ravel())
    return np.sqrt(flat[: int(0.99 * flat.size)].mean())


def shown(pixels):
    """As a display would show them: sRGB, cut off."""
    x = np.clip(pixels, 0, 1)
    return np.where(x <= 0.0031308, 12.92 * x, 1.055 * x ** (1 / 2.4) - 0.055)


def error(names):
    """Seconds and error of every program; with PLOT a drawing of them."""
    size = int(os.environ.get("SIZE", 512))
    print(
        "| scene | program | samples | seconds | RMSE | without the worst 1 % | sRGB"
        " | seconds to Dioptric's RMSE | to its trimmed | to its sRGB |"
    )
    print("|---|---|---|---|---|---|---|---|---|---|")
    drawn = {}
    for name in names:
        programs = {"Dioptric": lambda samples, seed: ours(name, size, samples, seed)}
        for variant in VARIANTS:
            programs[f"Mitsuba {variant}"] = Theirs(name, size, variant).render
            programs[f"Mitsuba {variant}"](1, 0)  # it compiles with the first picture
        told = plain(SCENES[name]()) if os.environ.get("CYCLES") else None
        cycles = Cycles(told, size) if told else None
        if cycles:
            programs["Cycles"] = cycles.render
        reference = long_reference(name, size, programs[f"Mitsuba {VARIANTS[0]}"])
        for samples in (16, 64, 256):
            figures = {program: [] for program in programs}
            for seed in range(ROUNDS):
                for program, render in programs.items():
                    if "scalar" in program and samples > 64:
                        continue
                    pixels, seconds = render(samples, seed + 1)
                    square = (pixels - reference) ** 2
                    srgb = (shown(pixels) - shown(reference)) ** 2
                    figures[program].append((seconds, np.sqrt(square.mean()), trimmed(square), np.sqrt(srgb.mean())))
            own = np.median(figures["Dioptric"], axis=0)
            for program, values in figures.items():
                if values:
                    found = np.median(values, axis=0)
                    drawn.setdefault(name, {}).setdefault(program, []).append(found)
                    # The square of the error falls as the samples grow.
                    needed = [found[0] * (found[i] / own[i]) ** 2 / own[0] for i in (1, 2, 3)]
                    cells = [f"{found[0]:.2f}", *(f"{x:.4f}" for x in found[1:]), *(f"{x:.2f} x" for x in needed)]
                    print(f"| {name} | {program} | {samples} | {' | '.join(cells)} |", flush=True)
        if cycles:
            cycles.close()
    if "PLOT" in os.environ:
        pathlib.Path(os.environ["PLOT"]).write_text(plot(drawn))


def long_reference(name, size, mitsuba):
    """The mean of long pictures by Dioptric and by Mitsuba, half and half: nobody's own noise is taken for the truth."""
    kept = pathlib.Path(os.environ["KEEP"]) / f"{name}-{size}-{REFERENCE}.npy" if "KEEP" in os.environ else None
    if kept and kept.exists():
        return np.load(kept)
    half = max(REFERENCE // 2, 1)
    pass_size = min(512, half)
    theirs = np.mean([mitsuba(pass_size, 7000 + i)[0] for i in range(half // pass_size)], axis=0)
    mean = (ours(name, size, half, 999)[0] + theirs) / 2
    if kept:
        kept.parent.mkdir(parents=True, exist_ok=True)
        np.save(kept, mean)
    return mean


def keep(names):
    for name in names:
        long_reference(name, int(os.environ.get("SIZE", 512)), Theirs(name, int(os.environ.get("SIZE", 512)), VARIANTS[0]).render)


COLORS = {"Dioptric": "#d55e00", "Mitsuba llvm_ad_rgb": "#0072b2", "Mitsuba scalar_rgb": "#56b4e9", "Cycles": "#009e73"}


def plot(drawn):
    """Trimmed error over seconds, both by their logarithms, a panel a scene."""
    side, gap = 220, 70
    out = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {(side + gap) * len(drawn) + 20} 330"'
        ' font-family="sans-serif" font-size="11">',
        "<title>Time to error</title>",
        '<rect width="100%" height="100%" fill="white"/>',
    ]
    for column, (name, programs) in enumerate(drawn.items()):
        points = np.log10([(s, e) for found in programs.values() for s, _, e, _ in found])
        low, high = np.floor(points.min(axis=0) * 2) / 2, np.ceil(points.max(axis=0) * 2) / 2
        left, top = 60 + column * (side + gap), 45

        def place(seconds, rmse):
            x, y = (np.log10((seconds, rmse)) - low) / (high - low)
            return left + side * x, top + side * (1 - y)

        out.append(f'<text x="{left}" y="30" font-weight="bold">{name}: RMSE (trimmed) over seconds</text>')
        out.append(f'<rect x="{left}" y="{top}" width="{side}" height="{side}" fill="none" stroke="#999"/>')
        for axis in (0, 1):
            for k in np.arange(low[axis], high[axis] + 0.01, 0.5):
                value = f"{10**k:.2g}"
                if axis == 0:
                    x = left + side * (k - low[0]) / (high[0] - low[0])
                    out.append(f'<path d="M{x:.1f} {top}v{side}" stroke="#ddd"/>')
                    out.append(f'<text x="{x:.1f}" y="{top + side + 16}" text-anchor="middle">{value}</text>')
                else:
                    y = top + side * (1 - (k - low[1]) / (high[1] - low[1]))
                    out.append(f'<path d="M{left} {y:.1f}h{side}" stroke="#ddd"/>')
                    out.append(f'<text x="{left - 5}" y="{y + 4:.1f}" text-anchor="end">{value}</text>')
        for row, (program, found) in enumerate(programs.items()):
            places = [place(s, e) for s, _, e, _ in found]
            line = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
            out.append(f'<polyline points="{line}" fill="none" stroke="{COLORS[program]}" stroke-width="2"/>')
            out += [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{COLORS[program]}"/>' for x, y in places]
            if column == 0:
                out.append(f'<text x="{60 + 160 * row}" y="315" fill="{COLORS[program]}">{program}</text>')
    return "\n".join([*out, "</svg>", ""])


if __name__ == "__main__":
    sys.path.insert(0, str(HERE))
    tasks = {"agree": agree, "error": error, "keep": keep}
    if len(sys.argv) < 2 or sys.argv[1] not in tasks:
        sys.exit(__doc__)
    mi.set_variant(VARIANTS[0])
    from scenes import SCENES

    tasks[sys.argv[1]](sys.argv[2:] or list(SCENES))
