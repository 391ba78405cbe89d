"""Renderings of scene files by Mitsuba 3, also of those that it refuses for a detail that changes no image."""

import re
import sys
from pathlib import Path

# What is changed in a scene file that Mitsuba 3 refuses as it is; the integrator is given instead by `path_tracer`.
EDITS = [
    (r"<!--.*?-->", ""),
    (r"<integrator\b[^>]*/>", ""),
    (r"<integrator\b.*?</integrator>(\s*</integrator>)?", ""),
    (r"<path\b[^>]*/>", ""),
    (r"\blookAt\b", "lookat"),
    (r'(?<=type=")[A-Z]', lambda match: match[0].lower()),
    (r'<spectrum( name="\w+") value="(\s*[\d.]+[\s,]+[\d.]+[\s,]+[\d.]+\s*)"\s*/>', r'<rgb\1 value="\2"/>'),
]

# Most parameters that Mitsuba 3 does not know and that are left out of a file.
MAX_UNKNOWN = 30


def path_tracer(text, depth):
    """A path tracer under the limits that `check` prints: "at most 6 edges, Russian roulette from 5 edges on"."""
    import mitsuba as mi

    longest = re.match(r"at most (\d+) edges", depth)
    hidden = re.search(r'"hide_?emitters"\s+value="true"', text, re.IGNORECASE)
    return mi.load_dict({
        "type": "path",
        "max_depth": int(longest[1]) if longest else -1,
        "rr_depth": int(re.search(r"from (\d+) edges", depth)[1]),
        "hide_emitters": hidden is not None,
    })


def without(text, error):
    """The scene file without the parameters that an error of Mitsuba's names; None if it names none."""
    for name in re.findall(r"\w+", error.partition("unreferenced")[2].partition("\n")[2]):
        spelled = name.replace("_", "_?")
        fewer = re.sub(rf'<\w+\s[^<>]*name="{spelled}"[^<>]*/>', "", text, flags=re.IGNORECASE)
        if fewer != text:
            return fewer
    return None


def load(path, defines, depth):
    """The scene, and an integrator in place of its own if the file had to be edited."""
    import mitsuba as mi

    try:
        return mi.load_file(str(path), **defines), None
    except RuntimeError:
        text = path.read_text(encoding="utf-8", errors="replace").lstrip("\ufeff \r\n\t")
    integrator = path_tracer(text, depth)
    for pattern, replacement in EDITS:
        text = re.sub(pattern, replacement, text, flags=re.DOTALL)
    resolver = mi.Thread.file_resolver()
    resolver.prepend(str(path.parent))
    try:
        for _ in range(MAX_UNKNOWN):
            try:
                return mi.load_string(text, **defines), integrator
            except RuntimeError as error:
                fewer = without(text, str(error))
                if fewer is None:
                    raise
                text = fewer
        raise RuntimeError(f"more than {MAX_UNKNOWN} parameters that Mitsuba does not know")
    finally:
        del resolver[0]


def render(path, defines, depth, size, spp, seeds):
    """Renderings with different seeds, and whether the file had to be edited; None if Mitsuba cannot."""
    import mitsuba as mi
    import numpy as np

    try:
        scene, integrator = load(Path(path), defines, depth)
        params = mi.traverse(scene)
        film = next(key for key in params.keys() if key.endswith("film.size"))
        params[film] = size
        params[film.replace("size", "crop_size")] = size
        params[film.replace("size", "crop_offset")] = (0, 0)
        params.update()
        how = {} if integrator is None else {"integrator": integrator}
        images = [np.array(mi.render(scene, spp=spp, seed=seed, **how))[..., :3] for seed in seeds]
    except (RuntimeError, StopIteration, KeyError) as error:
        print(f"{path}: Mitsuba: {error}", file=sys.stderr)
        return None
    return images, integrator is not None
