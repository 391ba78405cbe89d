"""Measures the choices that docs/mutations.md discusses, and writes its tables and chart.

    python3 docs/mutations.py --metrolight target/release/metrolight --output out/mutations --write

For every scene it renders a reference by mmlt and runs `metrolight converge --sweep` for every choice, two scenes at
a time on one thread each. `--from` makes the tables and the chart from the files of an earlier run. Requires the
packages in docs/requirements.txt. The text and the captions of docs/mutations.md, which state the length and the number
of the runs, are written by hand: update them after a run with other settings.
"""

import argparse
import concurrent.futures
import json
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[1]

SCENES = {
    "cornell": "128x128",
    "spheres": "128x96",
    "pool": "128x96",
    "torus-in-glass": "128x96",
    "door": "128x96",
    "bidir": "128x96",
    "rough-glass": "134x96",
    "lost-caustic": "128x96",
}

SWEEPS = {
    "importance-map": ["on", "off"],
    "direct": ["separate", "joint"],
    "threshold": ["1", "4", "16", "64"],
    "small-step": [
        "log:0.0000038146973:0.015625",
        "log:0.0009765625:0.015625",
        "log:0.0000038146973:0.0625",
        "gaussian:0.01",
    ],
}


def measure(program, scene, seconds, repeats, output):
    """Renders the reference and all sweeps of one scene into `output`."""
    folder = output / scene
    folder.mkdir(parents=True, exist_ok=True)
    common = [program, "-q", "--threads", "1", "--size", SCENES[scene]]
    path = ROOT / "scenes" / scene / "scene.xml"
    reference = folder / "reference.exr"

    def run(command, *words):
        subprocess.run(
            [common[0], command, path, *common[1:], *map(str, words)], check=True, stderr=subprocess.DEVNULL
        )

    run("render", "--specular", "off", "--integrator", "mmlt", "--time", 8 * seconds, "--seed", 1000, "-o", reference)
    for name, values in SWEEPS.items():
        sweep = f"{name}={','.join(values)}"
        run(
            *("converge", "--specular", "off", "--integrators", "mmlt", "--sweep", sweep, "--time", seconds, "--repeats", repeats),
            *("--reference", reference, "-o", folder / name),
        )
    print(scene, "done", flush=True)


def errors(output):
    """errors[sweep][value][scene]: the final relMSE over all pixels, and without the worst 0.1% of the pixels."""
    found = {}
    for scene in SCENES:
        for name, values in SWEEPS.items():
            data = json.loads((output / scene / name / "convergence.json").read_text())
            for value, variant in zip(values, data["variants"], strict=True):
                last = variant["points"][-1]
                pair = (last["relative_mse"], last["relative_mse_trimmed"])
                found.setdefault(name, {}).setdefault(value, {})[scene] = pair
    return found


def table(of_values):
    """One row per scene, one column per value: relMSE, in parentheses without the worst 0.1% of the pixels."""
    lines = ["| scene | " + " | ".join(f"`{value}`" for value in of_values) + " |"]
    lines.append("| --- |" + " --: |" * len(of_values))
    for scene in SCENES:
        cells = [f"{of[scene][0]:.3g} ({of[scene][1]:.3g})" for of in of_values.values()]
        lines.append(f"| `{scene}` | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def chart(found, path):
    """One panel per choice: the error without the worst 0.1% of the pixels, relative to that of the first value."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt
    from matplotlib.ticker import NullFormatter

    plt.rcParams["svg.hashsalt"] = "metrolight"
    figure, axes = plt.subplots(1, len(found), figsize=(13, 4.6), sharey=True, layout="constrained")
    markers = "osD^"
    for axis, (name, of_values) in zip(axes, found.items()):
        first = next(iter(of_values.values()))
        for marker, (value, of) in zip(markers, of_values.items()):
            ratios = [of[scene][1] / first[scene][1] for scene in SCENES]
            axis.semilogx(ratios, range(len(SCENES)), marker, label=value, fillstyle="none")
        axis.axvline(1.0, color="0.7", zorder=0)
        axis.set_xlim(0.25, 2.0)
        axis.set_xticks([0.25, 0.5, 1, 2], ["1/4", "1/2", "1", "2"])
        axis.xaxis.set_minor_formatter(NullFormatter())
        axis.set_title(name)
        axis.set_xlabel("relMSE relative to the first value")
        axis.grid(axis="y", alpha=0.3)
        axis.legend(loc="upper center", bbox_to_anchor=(0.5, -0.16), fontsize=8)
    axes[0].set_yticks(range(len(SCENES)), list(SCENES))
    axes[0].invert_yaxis()
    figure.savefig(path, metadata={"Date": None})


def write(found):
    """Writes tables and chart into docs/."""
    page = ROOT / "docs/mutations.md"
    text = page.read_text()
    for name, of_values in found.items():
        begin, end = f"<!-- {name} -->", "<!-- end -->"
        before, rest = text.split(begin)
        text = f"{before}{begin}\n\n{table(of_values)}\n\n{end}{rest.split(end, 1)[1]}"
    page.write_text(text)
    chart(found, ROOT / "docs/images/mutations.svg")


def main():
    """Measures the sweeps, or reads an earlier run, and prints or writes the results."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--metrolight", default=ROOT / "target/release/metrolight")
    parser.add_argument("--output", type=pathlib.Path, default=pathlib.Path("out/mutations"))
    parser.add_argument("--seconds", type=float, default=20, help="seconds of one render [default: 20]")
    parser.add_argument("--repeats", type=int, default=3, help="seeds of each variant [default: 3]")
    parser.add_argument("--from", dest="measured", action="store_true", help="measure nothing: use the files in OUTPUT")
    parser.add_argument("--write", action="store_true", help="write into docs/mutations.md and docs/images/")
    args = parser.parse_args()
    if not args.measured:
        if not pathlib.Path(args.metrolight).is_file():
            parser.error(f"{args.metrolight} does not exist: build it with `cargo build --release`, or give its path with --metrolight")
        with concurrent.futures.ThreadPoolExecutor(2) as pool:
            work = lambda scene: measure(args.metrolight, scene, args.seconds, args.repeats, args.output)
            list(pool.map(work, SCENES))
    found = errors(args.output)
    if args.write:
        write(found)
    else:
        for name, of_values in found.items():
            print(f"{name}\n\n{table(of_values)}\n")


if __name__ == "__main__":
    main()
