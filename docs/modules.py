"""Draws the modules of src/ and the imports between them as docs/images/modules.svg.

    python3 docs/modules.py

The rows are the order that tests/modules.rs declares. An arrow is an import of one module by another, read from the
sources without their comments and tests. An arrow is left out if other arrows lead from its start to its end.
"""

import re
from html import escape
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
WIDTH, ROW, BOX_WIDTH, BOX_HEIGHT = 760, 46, 118, 28

ABOUT = {
    "commands": "command line",
    "convergence": "error against time",
    "diagnosis": "tests of chains",
    "render": "drivers",
    "analysis": "lost and rare light",
    "integrators": "path samplers",
    "technique": "Veach's (s, t)",
    "path": "vertices, MIS",
    "markov": "chains, mutations",
    "mitsuba": "scene files",
    "scene": "lights, BSDFs",
    "bvh": "nearest hit",
    "sampling": "sample values",
    "metrics": "relMSE, FLIP, bias",
    "film": "splats, images",
    "plot": "charts",
    "statistics": "tests, moments",
    "math": "colours, frames",
}


def order():
    """The rows of modules, from top to bottom."""
    text = (ROOT / "tests/modules.rs").read_text(encoding="utf-8")
    declared = re.search(r"const ORDER.*?= \[(.*?)\n\];", text, re.DOTALL)[1]
    rows = [re.findall(r'"(\w+)"', line) for line in declared.splitlines() if "&[" in line]
    return [row for row in rows if row != ["fault"]]


def sources(module):
    """The files of a module, without those of its tests."""
    for path in sorted((ROOT / "src" / module).rglob("*.rs")):
        if "tests" not in path.parts and not path.stem.startswith("test"):
            yield path


def imports(module, modules):
    """The modules that a module uses."""
    used = set()
    for path in sources(module):
        code = path.read_text(encoding="utf-8").split("#[cfg(test)]\nmod tests {")[0]
        code = re.sub(r"//[^\n]*", "", code)
        # The commands belong to the binary, which names the library.
        root = "metrolight" if module == "commands" else "crate"
        used.update(re.findall(rf"\b{root}::(\w+)", code))
    return (used & modules) - {module}


def reduced(uses):
    """The arrows without those that others imply."""
    reach = {}
    for name in reversed(list(uses)):
        reach[name] = uses[name].union(*(reach[other] for other in uses[name]))
    return {
        name: {o for o in others if not any(o in reach[via] for via in others - {o})} for name, others in uses.items()
    }


def main():
    rows = order()
    modules = {name for row in rows for name in row}
    place = {}
    for i, row in enumerate(rows):
        for j, name in enumerate(row):
            # Neighbouring rows are shifted so that arrows pass between boxes.
            centre = WIDTH / 2 + (j - (len(row) - 1) / 2) * 170 + (0 if len(row) > 1 else 95 * (i % 2 * 2 - 1))
            place[name] = (centre, 24 + i * ROW)
    arrows = reduced({name: imports(name, modules) for name in place})
    lines = []
    for name, (x, y) in place.items():
        for other in sorted(arrows[name]):
            x2, y2 = place[other]
            side = 1 if (x + x2) / 2 >= WIDTH / 2 else -1
            rows_between = (y2 - y) / ROW
            bend = side * min(34 * (rows_between - 1), 150)
            start, end = x + side * BOX_WIDTH / 2 * 0.8, x2 + side * BOX_WIDTH / 2 * 0.8
            top, bottom = y + BOX_HEIGHT / 2, y2 - BOX_HEIGHT / 2
            lines.append(
                f'<path d="M{start:.0f} {top:.0f} C{start + bend:.0f} {top + 18:.0f} '
                f'{end + bend:.0f} {bottom - 18:.0f} {end:.0f} {bottom:.0f}"/>'
            )
    boxes = []
    for name, (x, y) in place.items():
        boxes.append(
            f'<rect x="{x - BOX_WIDTH / 2:.0f}" y="{y - BOX_HEIGHT / 2:.0f}" width="{BOX_WIDTH}" '
            f'height="{BOX_HEIGHT}" rx="4"/>'
            f'<text x="{x:.0f}" y="{y - 1:.0f}" class="name">{name}</text>'
            f'<text x="{x:.0f}" y="{y + 10:.0f}" class="about">{escape(ABOUT[name])}</text>'
        )
    height = 24 + len(rows) * ROW
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{height}" '
        f'viewBox="0 0 {WIDTH} {height}" font-family="sans-serif">\n'
        '<style>path{fill:none;stroke:#8a9bb0;stroke-width:1;marker-end:url(#head)}'
        "rect{fill:#fff;stroke:#31455c}.name{font-size:12px;font-weight:bold;text-anchor:middle;fill:#1b2733}"
        ".about{font-size:9px;text-anchor:middle;fill:#4a5a6a}</style>\n"
        '<defs><marker id="head" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="6" markerHeight="6" '
        'orient="auto"><path d="M0 0L8 4L0 8z" style="fill:#8a9bb0;stroke:none;marker-end:none"/></marker></defs>\n'
        f'<rect width="{WIDTH}" height="{height}" style="fill:#fff;stroke:none"/>\n'
        + "\n".join(lines + boxes)
        + "\n</svg>\n"
    )
    (ROOT / "docs/images/modules.svg").write_text(svg, encoding="utf-8")


if __name__ == "__main__":
    main()
