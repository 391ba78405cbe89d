"""Renders the references with Mitsuba 3: tests/references/NAME.exr and manifest.json.

    pip install -r tests/references/requirements.txt
    python3 tests/references/make_references.py [NAME...]

Mitsuba's `llvm` variants need the LLVM library (Debian: libllvm19); its place can be given in
DRJIT_LIBLLVM_PATH. Names limit the work to some references; the manifest always lists all.

Each reference is made of independent renderings of its scene with the `path` integrator, and has two
files of 32-bit channels:

- NAME.exr: R, G, B hold the mean over the renderings; variance.R, variance.G, variance.B the estimated
  variance of that mean, per pixel: the sample variance over the renderings divided by their number.
- NAME.tiles.exr: every rendering by itself, one below the other, each reduced to the means of tiles of
  8 x 4 pixels. The variance of a larger tile is that of its means over the renderings. It is the sum of
  its pixels' variances only under a box filter: a wider one lets neighbours share samples.
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
TILE_WIDTH, TILE_HEIGHT = 8, 4
# Samples per pixel that Mitsuba takes at once: more take too much memory.
MOST_AT_ONCE = 1024


def reference(scene, spp, methods="all", name=None, **defines):
    """One entry of the manifest; spp is that of one rendering, a multiple of MOST_AT_ONCE if more."""
    path = scene if "/" in scene else f"tests/references/scenes/{scene}.xml"
    # The depth limit of the scene is written down as a number of its own.
    text = (ROOT / path).read_text(encoding="utf-8") if (ROOT / path).exists() else ""
    default = re.search(r'^\s*<(?:default|integer) name="max_depth" value="(\d+)" ?/>', text, re.MULTILINE)
    return {
        "name": name or scene.split("/")[-2 if "/" in scene else -1],
        "scene": path,
        "defines": defines,
        "width": WIDTH,
        "height": HEIGHT,
        "max_depth": int(default[1]) if default else None,
        "samples_per_pixel": spp,
        "renderings": RENDERINGS,
        "tile": [TILE_WIDTH, TILE_HEIGHT],
        "first_seed": 0,
        "methods": methods,
    }


# Small lamps become large ones of the same power, which a path tracer can find. Where light that
# connects to the lens through no glass cannot be found by a path tracer at all, the reference is
# that of the path tracer alone. Samples are many where the noise is strong: a quarter of the image is to
# be known to 0.1%, or as well as some minutes allow.
REFERENCES = [
    reference("scenes/cornell/scene.xml", 2048),
    reference("scenes/spheres/scene.xml", 4096, light_size="0.25", light_radiance="38.4, 34.6, 28.8"),
    reference("scenes/pool/scene.xml", 2048, light_radius="0.5", light_radiance="29.4, 27.5, 23.7"),
    reference("scenes/torus-in-glass/scene.xml", 1024, light_radius="0.8", light_radiance="23.6, 20.8, 16.3"),
    reference("scenes/door/scene.xml", 2048),
    reference(
        "scenes/bidir/scene.xml", 2048,
        bulb_radius="0.1", bulb_radiance="144, 114, 72", spot_radiance="40, 37, 32", housing_reflectance="0",
    ),
    reference("scenes/rough-glass/scene.xml", 1024, light_radius="0.4", light_radiance="46, 42.5, 37"),
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
        for name, spp in (("cornell-box", 256), ("veach-mis", 8192), ("veach-bidir", 2048))
    ],
    *[
        reference("camera", 128, name=f"camera_{axis}", fov_axis=axis)
        for axis in ("x", "y", "diagonal", "smaller", "larger")
    ],
    # Lit by what light subpaths scatter at tilted shading normals and through water.
    reference("tests/scenes/adjoint.xml", 1024, name="adjoint"),
    # Materials made of others, and anisotropic ones.
    *[reference(name, 256) for name in (
        "mask", "thindielectric", "blendbsdf", "anisotropic", "normalmap", "bumpmap", "principled", "principledthin",
    )],
    *[reference(name, 256) for name in (
        "spot", "projector", "area_texture", "cylinder", "disk", "instances", "orthographic", "principal_point", "hidden",
        "spectrum",
    )],
]
# The small scenes have much in common: with the same random numbers their noise would be alike too.
for number, entry in enumerate(entry for entry in REFERENCES if entry["scene"].startswith("tests/")):
    entry["first_seed"] = 1000 * (number + 1)


def rendering(scene, entry, index):
    """One rendering, of shape (height, width, 3) in float64; no two of them share a random number."""
    spp = entry["samples_per_pixel"]
    at_once = min(spp, MOST_AT_ONCE)
    parts = spp // at_once
    first = entry["first_seed"] + index * parts
    images = [np.array(mi.render(scene, spp=at_once, seed=seed)) for seed in range(first, first + parts)]
    return np.mean([image.astype(np.float64)[..., :3] for image in images], axis=0)


def tiles(image, width=TILE_WIDTH, height=TILE_HEIGHT):
    """Means over tiles of so many pixels."""
    rows, columns = image.shape[0] // height, image.shape[1] // width
    return image.reshape(rows, height, columns, width, 3).mean(axis=(1, 3))


def render(entry):
    """The mean, the variance of the mean, both per pixel, and the tiles of all renderings."""
    size = {"resx": str(entry["width"]), "resy": str(entry["height"]), "integrator": "path"}
    scene = mi.load_file(str(ROOT / entry["scene"]), **size, **entry["defines"])
    images = np.array([rendering(scene, entry, i) for i in range(entry["renderings"])])
    return images.mean(axis=0), images.var(axis=0, ddof=1) / len(images), np.array([tiles(i) for i in images])


def report(entry, renderings, seconds):
    """Prints how well known the image, its quarters and its tiles of 8 x 8 pixels are."""
    floor = 0.05 * renderings.mean()
    errors = []
    for width, height in ((4, 6), (2, 3), (1, 2)):
        means = np.array([tiles(i, width, height) for i in renderings])
        error = means.std(axis=0, ddof=1) / np.sqrt(len(means)) / np.maximum(means.mean(axis=0), floor)
        errors.append(f"{100 * np.median(error):.3f}% (worst {100 * error.max():.3f}%)")
    print(
        f"{entry['name']:22} mean {renderings.mean():8.4f}  error of image {errors[0]}, quarters {errors[1]},"
        f" tiles {errors[2]}  {seconds:5.1f} s",
        flush=True,
    )


def write(name, pixels, channels):
    bitmap = mi.Bitmap(pixels.astype(np.float32), mi.Bitmap.PixelFormat.MultiChannel, channel_names=channels)
    bitmap.write(str(HERE / name))


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
        mean, variance, renderings = render(entry)
        report(entry, renderings, time.process_time() - start)
        channels = ["R", "G", "B"]
        both = channels + [f"variance.{channel}" for channel in channels]
        write(f"{entry['name']}.exr", np.concatenate([mean, variance], axis=2), both)
        write(f"{entry['name']}.tiles.exr", np.concatenate(renderings), channels)
    # One entry a line: a change of one shows as a change of one.
    lines = ",\n".join("  " + json.dumps(entry) for entry in REFERENCES)
    (HERE / "manifest.json").write_text(f"[\n{lines}\n]\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
