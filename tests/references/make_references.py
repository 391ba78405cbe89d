"""Renders the references with Mitsuba 3: tests/references/NAME.exr and manifest.json.

    pip install -r tests/references/requirements.txt
    python3 tests/references/make_references.py [NAME...]

Mitsuba's `llvm` variants need the LLVM library (Debian: libllvm19); its place can be given in
DRJIT_LIBLLVM_PATH. Names limit the work to some references; the manifest always lists all.

Each reference is the mean of independent renderings of its scene with the `path` integrator. The
file has six 32-bit channels: R, G, B hold the mean over the renderings, variance.R, variance.G,
variance.B the estimated variance of that mean, per pixel: the sample variance over the renderings
divided by their number. The mean over a tile of n pixels has the variance sum(variance) / n^2.
"""

import json
import re
import sys
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
WIDTH, HEIGHT, RENDERINGS = 32, 24, 32


def reference(scene, spp, methods="all", name=None, **defines):
    """One entry of the manifest; spp is that of one rendering."""
    path = scene if "/" in scene else f"tests/references/scenes/{scene}.xml"
    # The depth limit of the scene is written down as a number of its own.
    text = (ROOT / path).read_text(encoding="utf-8") if (ROOT / path).exists() else ""
    default = re.search(r'^\s*<default name="max_depth" value="(\d+)" ?/>', text, re.MULTILINE)
    return {
        "name": name or scene.split("/")[-2 if "/" in scene else -1],
        "scene": path,
        "defines": defines,
        "width": WIDTH,
        "height": HEIGHT,
        "max_depth": int(default[1]) if default else None,
        "samples_per_pixel": spp,
        "renderings": RENDERINGS,
        "methods": methods,
    }


# Small lamps become large ones of the same power, which a path tracer can find. Where light that
# connects to the lens through no glass cannot be found by a path tracer at all, the reference is
# that of the path tracer alone.
REFERENCES = [
    reference("scenes/cornell/scene.xml", 256),
    reference("scenes/spheres/scene.xml", 1024, light_size="0.25", light_radiance="38.4, 34.6, 28.8"),
    reference("scenes/pool/scene.xml", 1024, light_radius="0.5", light_radiance="29.4, 27.5, 23.7"),
    reference("scenes/torus-in-glass/scene.xml", 512, light_radius="0.8", light_radiance="23.6, 20.8, 16.3"),
    reference("scenes/door/scene.xml", 1024),
    reference(
        "scenes/bidir/scene.xml", 512,
        bulb_radius="0.1", bulb_radiance="144, 114, 72", spot_radiance="40, 37, 32", housing_reflectance="0",
    ),
    reference("scenes/rough-glass/scene.xml", 512, light_radius="0.4", light_radiance="46, 42.5, 37"),
    reference("scenes/lost-caustic/scene.xml", 256, methods="path"),
    *[reference(name, 256) for name in (
        "diffuse", "conductor", "roughconductor", "plastic", "roughplastic", "twosided",
        "bitmap", "to_uv", "checkerboard", "constant", "envmap", "envmap_seen", "directional", "point",
        "area_sides", "area_inside", "normals", "transforms", "thinlens", "tent", "gaussian",
    )],
    *[reference(name, 512) for name in (
        "dielectric", "roughdielectric", "specular_textures", "glass_normals", "flipped_glass", "mirrored", "in_glass",
    )],
    reference("area", 1024),
    # Published scenes, which are not part of the project: skipped where they are missing.
    *[
        reference(f"../shared/scenes/{name}/scene.xml", spp, name=f"published-{name}")
        for name, spp in (("cornell-box", 256), ("veach-mis", 512), ("veach-bidir", 1024))
    ],
    *[
        reference("camera", 128, name=f"camera_{axis}", fov_axis=axis)
        for axis in ("x", "y", "diagonal", "smaller", "larger")
    ],
]


def render(entry):
    """The mean and the variance of the mean, each of shape (height, width, 3) in float64."""
    size = {"resx": str(entry["width"]), "resy": str(entry["height"]), "integrator": "path"}
    scene = mi.load_file(str(ROOT / entry["scene"]), **size, **entry["defines"])
    # Welford's recurrence: the images are too alike to subtract sums of squares.
    mean = np.zeros((entry["height"], entry["width"], 3))
    squares = np.zeros_like(mean)
    for seed in range(entry["renderings"]):
        image = np.array(mi.render(scene, spp=entry["samples_per_pixel"], seed=seed), dtype=np.float64)[..., :3]
        delta = image - mean
        mean += delta / (seed + 1)
        squares += delta * (image - mean)
    return mean, squares / (entry["renderings"] * (entry["renderings"] - 1))


def report(entry, mean, variance, seconds):
    """Prints how well known the image and its tiles of 8 x 8 pixels are."""
    tiles = lambda array: array.reshape(HEIGHT // 8, 8, WIDTH // 8, 8, 3).mean(axis=(1, 3))
    tile_mean, tile_error = tiles(mean), np.sqrt(tiles(variance) / 64)
    relative = tile_error / np.maximum(tile_mean, 0.05 * mean.mean())
    total = np.sqrt(variance.mean(axis=(0, 1)) / (WIDTH * HEIGHT)) / mean.mean(axis=(0, 1))
    print(
        f"{entry['name']:20} mean {mean.mean():8.4f}  error {100 * total.max():6.3f} %"
        f"  of tiles {100 * np.median(relative):6.3f} % (worst {100 * relative.max():6.3f} %)  {seconds:5.1f} s",
        flush=True,
    )


def main():
    mi.set_variant("llvm_ad_rgb", "scalar_rgb")
    chosen = set(sys.argv[1:])
    unknown = chosen - {entry["name"] for entry in REFERENCES}
    if unknown:
        sys.exit(f"no such reference: {', '.join(sorted(unknown))}")
    for entry in REFERENCES:
        if chosen and entry["name"] not in chosen:
            continue
        if not (ROOT / entry["scene"]).exists():
            print(f"{entry['name']:20} skipped: {entry['scene']} is not here")
            continue
        start = time.process_time()
        mean, variance = render(entry)
        report(entry, mean, variance, time.process_time() - start)
        pixels = np.concatenate([mean, variance], axis=2).astype(np.float32)
        names = ["R", "G", "B", "variance.R", "variance.G", "variance.B"]
        bitmap = mi.Bitmap(pixels, mi.Bitmap.PixelFormat.MultiChannel, channel_names=names)
        bitmap.write(str(HERE / f"{entry['name']}.exr"))
    # One entry a line: a change of one shows as a change of one.
    lines = ",\n".join("  " + json.dumps(entry) for entry in REFERENCES)
    (HERE / "manifest.json").write_text(f"[\n{lines}\n]\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
