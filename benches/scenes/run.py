"""Which scenes of a folder load, and how their images compare with those of Mitsuba 3.

    cargo build --release
    python3 benches/scenes/run.py FOLDER [--list LIST.txt] [--spp 64] [--size 64x48] [--only PART]

Prints a Markdown table, a line for each scene: whether it loads or what it is refused for, the mean of the image
over that of Mitsuba 3's with its standard error, and the number of tiles of 8 x 8 pixels that differ. The scenes
are the files in LIST.txt, or else all XML files below the folder whose root is a <scene>.

Null hypothesis for each tile: the means over our renderings and over Mitsuba's are equal. Each program renders
SEEDS times; a tile differs if |z| of the difference of its luminance exceeds the threshold of the Bonferroni
correction over the tiles of an image at ALPHA, so that a correct image has a differing tile with probability
ALPHA. A star after the ratio says that Mitsuba 3 refuses the file, and rendered it without what it does not know
(mitsuba3.py). Without the Python package `mitsuba` the last two columns are empty.
"""

import argparse
import json
import math
import re
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import mitsuba3

ROOT = Path(__file__).resolve().parents[2]
PROGRAM = ROOT / "target/release/metrolight"
SEEDS = 8
ALPHA = 1e-3
TILE = 8
LUMINANCE = (0.2126, 0.7152, 0.0722)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--list", type=Path, help="file with one path a line, relative to the folder")
    parser.add_argument("--spp", type=int, default=64, help="samples per pixel of one rendering")
    parser.add_argument("--size", default="64x48", help="the images fill this size, in the scene's proportions")
    parser.add_argument("--only", default="", help="only scenes whose path contains this")
    parser.add_argument("-D", dest="defines", action="append", default=[], metavar="NAME=VALUE")
    parser.add_argument("--program", type=Path, default=PROGRAM, help="the program; its release build by default")
    return parser.parse_args()


def scenes(folder, listed):
    if listed:
        return listed.read_text(encoding="utf-8").split()
    is_scene = re.compile(rb"^\s*(?:\xef\xbb\xbf)?(?:<[?!].*?>\s*)*<scene", re.DOTALL)
    files = (path for path in folder.rglob("*.xml") if is_scene.match(path.read_bytes()[:4096]))
    return sorted(str(path.relative_to(folder)) for path in files)


def run(program, *words):
    return subprocess.run([program, *map(str, words)], capture_output=True, text=True, check=False)


def check(path, args, defines):
    """The report of the scene."""
    return json.loads(run(args.program, "check", path, "--json", *defines).stdout)


def refusals(report):
    """The reasons for which a scene is refused, without their places; none if it loads."""
    reasons = [re.sub(r"^\S+?:\d+:\d+: ", "", reason) for reason in report.get("errors", [])]
    reasons = [re.sub(r"/\S*/", "", reason) for reason in reasons]
    reasons = [re.sub(r" \(known: .*\)|; did you mean.*", "", reason) for reason in reasons]
    return list(dict.fromkeys(reasons))


def size_within(report, largest):
    """The largest size up to `largest` in the proportions of the scene's film.

    Mitsuba fixes the horizontal field of view when it loads a scene: with other proportions it shows another image
    than a scene with a film of that size.
    """
    width, height = map(int, re.match(r"(\d+) x (\d+)", report["contents"]["image"]).groups())
    divisor = math.gcd(width, height)
    unit = (width // divisor, height // divisor)
    times = min(largest[0] // unit[0], largest[1] // unit[1])
    if times > 0:
        return unit[0] * times, unit[1] * times
    scale = min(largest[0] / width, largest[1] / height)
    return max(1, round(width * scale)), max(1, round(height * scale))


def ours(path, args, defines, size, folder):
    """Renderings with different seeds."""
    images = []
    for seed in range(SEEDS):
        out = Path(folder) / "ours.exr"
        words = ["--spp", args.spp, "--size", f"{size[0]}x{size[1]}", "--seed", seed, "-q", "-o", out]
        finished = run(args.program, "render", path, "--integrator", "path", *words, *defines)
        if finished.returncode != 0:
            return None
        images.append(read(out))
    return images


def read(path):
    import mitsuba as mi
    import numpy as np

    return np.array(mi.Bitmap(str(path)).convert(mi.Bitmap.PixelFormat.RGB, mi.Struct.Type.Float32, False))


def compare(own, other):
    """The ratio of the means and its standard error, and how many of how many tiles differ."""
    import numpy as np

    own, other = (np.stack(images).astype(np.float64) @ np.array(LUMINANCE) for images in (own, other))

    def tiles(images):
        count, rows, columns = images.shape
        cut = images[:, : rows // TILE * TILE, : columns // TILE * TILE]
        return cut.reshape(count, rows // TILE, TILE, columns // TILE, TILE).mean(axis=(2, 4)).reshape(count, -1)

    a, b = tiles(own), tiles(other)
    error = np.sqrt((a.var(axis=0, ddof=1) + b.var(axis=0, ddof=1)) / len(a))
    # Tiles without variance, such as those of a black background, must be equal to rounding.
    error = np.maximum(error, 1e-4 * np.maximum(np.abs(b.mean(axis=0)), 1e-6))
    z = np.abs(a.mean(axis=0) - b.mean(axis=0)) / error
    # Student's t with 14 degrees of freedom is close to normal here but for its tails: a margin covers them.
    threshold = 1.6 * statistics.NormalDist().inv_cdf(1 - ALPHA / (2 * z.size))
    means = [images.mean(axis=(1, 2)) for images in (own, other)]
    ratio, spread = 1.0, 0.0
    if means[1].mean() > 0:
        ratio = means[0].mean() / means[1].mean()
        spread = np.sqrt(sum(m.var(ddof=1) / len(m) for m in means)) / means[1].mean()
    return ratio, spread, int((z > threshold).sum()), z.size


def main():
    args = arguments()
    defines = [word for define in args.defines for word in ("-D", define)]
    try:
        import mitsuba as mi

        mi.set_variant("scalar_rgb")
        mi.set_log_level(mi.LogLevel.Error)
        has_mitsuba = True
    except ImportError:
        has_mitsuba = False
    print("| scene | loads | mean / Mitsuba 3's | tiles that differ |\n| --- | --- | ---: | ---: |")
    loaded, total = 0, 0
    for name in scenes(args.folder, args.list):
        if args.only not in name:
            continue
        path = args.folder / name
        total += 1
        report = check(path, args, defines)
        reasons = refusals(report)
        ratio, differing = "", ""
        if not reasons:
            loaded += 1
            size = size_within(report, tuple(map(int, args.size.split("x"))))
            seeds = range(100, 100 + SEEDS)
            words = dict(define.split("=", 1) for define in args.defines)
            depth = report["contents"]["depth"]
            other = mitsuba3.render(path, words, depth, size, args.spp, seeds) if has_mitsuba else None
            if other is not None:
                with tempfile.TemporaryDirectory() as folder:
                    own = ours(path, args, defines, size, folder)
                if own is not None:
                    images, is_edited = other
                    mean, spread, count, tiles = compare(own, images)
                    ratio = f"{mean:.4f}{'*' if is_edited else ''} ± {spread:.4f}"
                    differing = f"{count} of {tiles}"
        verdict = "yes" if not reasons else "no: " + "; ".join(reasons)
        print(f"| `{name}` | {verdict} | {ratio} | {differing} |", flush=True)
    print(f"\n{loaded} of {total} load.")


if __name__ == "__main__":
    main()
