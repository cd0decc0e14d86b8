#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Renders the scenes of this folder by paths, with Dioptric and with Mitsuba 3, and compares them.

    bench/mitsuba/run.py agree [SCENE ...]    do the mean pictures agree?
    bench/mitsuba/run.py error [SCENE ...]    seconds and error at 16, 64 and 256 samples

Prints Markdown tables. Needs Python 3 with `pip install mitsuba numpy`. DIOPTRIC names the program, SEEDS how many
pictures of each program a mean is made of (8), SAMPLES their samples (256), SIZE their side (128); for `error` THREADS (2),
REFERENCE the samples of the reference (16384), ROUNDS how often each picture is made, in turn (3), VARIANTS which Mitsuba
("llvm_ad_rgb scalar_rgb"). The llvm ones need LLVM 16 or newer; DRJIT_LIBLLVM_PATH names it.

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
    size = int(os.environ.get("SIZE", 512))
    print("| scene | program | samples | seconds | RMSE | without the worst 1 % | sRGB | time x RMSE^2, of Dioptric's |")
    print("|---|---|---|---|---|---|---|---|")
    for name in names:
        programs = {"Dioptric": lambda samples, seed: ours(name, size, samples, seed)}
        scenes = {variant: Theirs(name, size, variant) for variant in VARIANTS}
        for variant, scene in scenes.items():
            programs[f"Mitsuba {variant}"] = scene.render
            scene.render(1, 0)  # it compiles with the first picture
        first = scenes[VARIANTS[0]]
        half = max(REFERENCE // 2, 1)
        pass_size = 1024
        theirs = np.mean([first.render(pass_size, 7000 + i)[0] for i in range(max(half // pass_size, 1))], axis=0)
        reference = (ours(name, size, half, 999)[0] + theirs) / 2
        for samples in (16, 64, 256):
            figures = {program: [] for program in programs}
            for seed in range(ROUNDS):
                for program, render in programs.items():
                    if "scalar" in program and samples > 64:
                        continue
                    pixels, seconds = render(samples, seed + 1)
                    square = (pixels - reference) ** 2
                    rmse, srgb = np.sqrt(square.mean()), np.sqrt(((shown(pixels) - shown(reference)) ** 2).mean())
                    figures[program].append((seconds, rmse, trimmed(square), srgb))
            own = np.median(figures["Dioptric"], axis=0)
            for program, values in figures.items():
                if values:
                    s, rmse, trim, srgb = np.median(values, axis=0)
                    ratio = s * trim**2 / (own[0] * own[2] ** 2)
                    print(
                        f"| {name} | {program} | {samples} | {s:.2f} | {rmse:.4f} | {trim:.4f} | {srgb:.4f} | {ratio:.2f} |",
                        flush=True,
                    )


if __name__ == "__main__":
    sys.path.insert(0, str(HERE))
    if len(sys.argv) < 2 or sys.argv[1] not in ("agree", "error"):
        sys.exit(__doc__)
    mi.set_variant(VARIANTS[0])
    from scenes import SCENES

    (agree if sys.argv[1] == "agree" else error)(sys.argv[2:] or list(SCENES))
