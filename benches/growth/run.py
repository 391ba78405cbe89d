"""Time and memory of a render against the size of the problem: triangles, pixels, depth, lights, chains.

    python benches/growth/run.py --metrolight target/release/metrolight --write

Every row is one render of a generated scene on one thread. Seconds are measured by the render itself, without loading,
and memory is the peak resident size of the process. Requires matplotlib (benches/field/requirements.txt).
"""

import argparse
import csv
import json
import math
import pathlib
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- growth:begin -->", "<!-- growth:end -->"


def grid_ply(path, triangles):
    """Writes a hilly square of about `triangles` triangles as a binary PLY file and returns their exact number."""
    side = max(1, round(math.sqrt(triangles / 2)))
    with open(path, "wb") as file:
        vertices = (side + 1) ** 2
        header = (
            f"ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n"
            "property float x\nproperty float y\nproperty float z\n"
            f"element face {2 * side * side}\nproperty list uchar int vertex_indices\nend_header\n"
        )
        file.write(header.encode())
        for j in range(side + 1):
            row = bytearray()
            for i in range(side + 1):
                x, z = 2 * i / side - 1, 2 * j / side - 1
                y = 0.1 * math.sin(9 * x) * math.cos(7 * z) + 0.02 * math.sin(60 * x + 40 * z)
                row += struct.pack("<fff", x, y, z)
            file.write(row)
        for j in range(side):
            row = bytearray()
            for i in range(side):
                a = j * (side + 1) + i
                b = a + side + 1
                row += struct.pack("<BiiiBiii", 3, a, b, a + 1, 3, a + 1, b, b + 1)
            file.write(row)
    return 2 * side * side


def scene(folder, triangles=1000, lights=1, depth=8):
    """Writes a hilly floor in an open white room with `lights` small lamps; returns the path of the scene and the
    number of triangles of the floor."""
    count = grid_ply(folder / "floor.ply", triangles)
    lamps = []
    side = math.ceil(math.sqrt(lights))
    for k in range(lights):
        x, z = ((k % side) + 0.5) / side * 1.8 - 0.9, ((k // side) + 0.5) / side * 1.8 - 0.9
        size = 0.5 / side
        lamps.append(
            f'<shape type="rectangle"><transform name="to_world"><scale value="{size:.6g}"/>'
            f'<rotate x="1" angle="90"/><translate x="{x:.6g}" y="1.2" z="{z:.6g}"/></transform>'
            '<emitter type="area"><rgb name="radiance" value="10"/></emitter></shape>'
        )
    path = folder / "scene.xml"
    path.write_text(
        f"""<scene version="3.0.0">
<integrator type="path"><integer name="max_depth" value="{depth}"/></integrator>
<sensor type="perspective"><float name="fov" value="60"/>
<transform name="to_world"><lookat origin="0, 0.9, -2.4" target="0, 0.2, 0" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="256"/><integer name="height" value="256"/><rfilter type="box"/></film>
</sensor>
<bsdf type="diffuse" id="white"><rgb name="reflectance" value="0.8"/></bsdf>
<shape type="ply"><string name="filename" value="floor.ply"/><ref id="white"/></shape>
<shape type="rectangle"><transform name="to_world"><scale value="2"/><translate z="1.5"/></transform>
<bsdf type="twosided"><ref id="white"/></bsdf></shape>
{chr(10).join(lamps)}
</scene>
"""
    )
    return path, count


def render(program, path, integrator, options):
    """Renders and returns the statistics of the render, with its peak resident size in MB."""
    with tempfile.TemporaryDirectory() as out:
        stats = pathlib.Path(out) / "stats.json"
        command = [program, "render", path, "--integrator", integrator, "--threads", "1", "-q"]
        command += ["-o", pathlib.Path(out) / "image.exr", "--stats", stats, *options]
        # A separate process measures the peak: RUSAGE_CHILDREN gives the maximum over all children so far.
        measure = (
            "import resource, subprocess, sys; code = subprocess.call(sys.argv[1:]); "
            "print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss); sys.exit(code)"
        )
        run = [sys.executable, "-c", measure, *map(str, command)]
        done = subprocess.run(run, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{' '.join(map(str, command))}\n{done.stderr}")
        statistics = json.loads(stats.read_text())
        statistics["megabytes"] = int(done.stdout.split()[-1]) / 1024
        return statistics


def experiments(largest):
    """Yields (parameter, value, arguments of the scene, integrator, options of the render)."""
    spp = ["--spp", "8"]
    for n in (10**3, 10**4, 10**5, 10**6, 10**7):
        if n <= largest:
            yield "triangles", n, {"triangles": n}, "bdpt", spp
    for side in (316, 1000, 2000, 4000):
        yield "pixels", side * side, {}, "bdpt", ["--size", f"{side}x{side}", "--spp", "1"]
    for depth in (3, 5, 10, 20, 50):
        yield "depth", depth, {"depth": depth}, "bdpt", spp
    for lights in (1, 10, 100, 1000, 10000, 100000):
        if lights <= largest:
            yield "lights", lights, {"lights": lights}, "bdpt", spp
    for chains in (1, 10, 100, 1000, 10000, 100000):
        options = ["--chains", str(chains), "--spp", "16", "--bootstrap", "100000"]
        yield "chains", chains, {}, "pssmlt", options


def measure(program, largest, table):
    """Renders all experiments and appends each result to a CSV file."""
    with open(table, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["grows", "value", "integrator", "microseconds_per_sample", "rays_per_sample", "megabytes"])
        for grows, value, arguments, integrator, options in experiments(largest):
            with tempfile.TemporaryDirectory() as folder:
                path, count = scene(pathlib.Path(folder), **arguments)
                if grows == "triangles":
                    value = count
                statistics = render(program, path, integrator, options)
            rays = statistics["closest_hit_rays"] + statistics["shadow_rays"]
            row = [
                grows,
                value,
                integrator,
                f"{1e6 / statistics['samples_per_second']:.3f}",
                f"{rays / statistics['samples']:.2f}",
                f"{statistics['megabytes']:.1f}",
            ]
            writer.writerow(row)
            file.flush()
            print(*row, flush=True)


def rows_of(table):
    """The rows of the CSV file, grouped by the parameter that grows."""
    groups = {}
    with open(table, newline="") as file:
        for row in csv.DictReader(file):
            groups.setdefault(row["grows"], []).append(row)
    return groups


def markdown(groups):
    """One table per parameter."""
    lines = []
    for grows, rows in groups.items():
        lines += ["", f"| {grows} | µs per sample | rays per sample | MB |", "| --: | --: | --: | --: |"]
        for row in rows:
            value = f"{int(row['value']):,}".replace(",", " ")
            lines.append(
                f"| {value} | {row['microseconds_per_sample']} | {row['rays_per_sample']} | {row['megabytes']} |"
            )
    return "\n".join(lines).strip()


def chart(groups, path):
    """Time and memory against each parameter, one column of panels per parameter, on logarithmic axes."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import NullFormatter

    plt.rcParams["svg.hashsalt"] = "metrolight"
    size = (3 * len(groups), 5)
    figure, axes = plt.subplots(2, len(groups), figsize=size, sharey="row", layout="constrained")
    for column, (grows, rows) in enumerate(groups.items()):
        x = [int(row["value"]) for row in rows]
        for axis, key in zip(axes[:, column], ("microseconds_per_sample", "megabytes")):
            axis.loglog(x, [float(row[key]) for row in rows], marker="o", color="#1f6f8b")
            axis.grid(alpha=0.3)
            for part in (axis.xaxis, axis.yaxis):
                part.set_minor_formatter(NullFormatter())
            if x[-1] <= 100:
                axis.set_xticks(x, x)
        axes[0, column].set_title(grows)
        axes[1, column].set_xlabel(grows)
    axes[0, 0].set_yticks([1, 2, 5], [1, 2, 5])
    axes[1, 0].set_yticks([10, 100, 1000], [10, 100, 1000])
    axes[0, 0].set_ylabel("µs per sample")
    axes[1, 0].set_ylabel("MB")
    figure.savefig(path, metadata={"Date": None})


def main():
    """Measures, or reads the CSV file, and prints or writes tables and chart."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--metrolight", default=ROOT / "target/release/metrolight", help="the binary")
    parser.add_argument("--largest", type=int, default=10**7, help="maximum number of triangles and of lights [default: 10000000]")
    parser.add_argument("--output", default="growth.csv", help="the CSV file [default: growth.csv]")
    parser.add_argument("--from-csv", action="store_true", help="measure nothing: use the existing CSV file")
    parser.add_argument("--write", action="store_true", help="write the tables into docs/performance.md and the chart into docs/images/")
    args = parser.parse_args()
    if not args.from_csv:
        if not pathlib.Path(args.metrolight).is_file():
            parser.error(f"{args.metrolight} does not exist: build it with `cargo build --release`, or give its path with --metrolight")
        measure(args.metrolight, args.largest, args.output)
    groups = rows_of(args.output)
    tables = markdown(groups)
    if not args.write:
        print(tables)
        return
    page = ROOT / "docs/performance.md"
    text = page.read_text()
    before, after = text.split(BEGIN)[0], text.split(END)[1]
    page.write_text(f"{before}{BEGIN}\n\n{tables}\n\n{END}{after}")
    chart(groups, ROOT / "docs/images/growth.svg")


if __name__ == "__main__":
    main()
