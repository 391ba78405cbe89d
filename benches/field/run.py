"""Compares Metrolight with LuxCore and Mitsuba 3: the same scenes, the same time, error against one reference.

    python benches/field/run.py                     # everything, into out/field
    python benches/field/run.py --resume            # continues an interrupted run
    python benches/field/run.py --from-csv out/field/field.csv --write

The steps:
 1. every scene is converted to the common subset (scene.py) and written for each program;
 2. all programs render cornell, and must agree in the brightness of the image and of its tiles;
 3. long renders make the references, with seeds that are not used in the measurements;
 4. for each seed and each scene, the programs render one after another, and the errors after a quarter, a half
    and all of the time are written to OUTPUT/field.csv;
 5. a table, OUTPUT/field.md, and a chart, OUTPUT/field.svg and .png, are made from the CSV file.

The text of docs/performance.md around table and chart, which states the length and the number of the runs, is written by
hand: update it after a run with other settings.

Loading a scene and compiling kernels is not counted as render time. docs/performance.md states what is the same for
all programs and what differs.
"""

import argparse
import shutil
import subprocess
import sys
from pathlib import Path

from problem import Problem

REPOSITORY = Path(__file__).resolve().parents[2]
SCENES = ["cornell", "spheres", "pool", "torus-in-glass", "door", "bidir", "rough-glass", "lost-caustic"]
DOCUMENT = REPOSITORY / "docs" / "performance.md"
CHART = REPOSITORY / "docs" / "images" / "field.svg"
TABLE = REPOSITORY / "docs" / "field.csv"

# Images are measured after these fractions of the time.
FRACTIONS = (0.25, 0.5, 1.0)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--scenes", type=_names, default=SCENES, help="names of folders in scenes/ [default: all]")
    parser.add_argument("--size", type=int, default=128, help="longer side of the image in pixels [default: 128]")
    parser.add_argument("--seconds", type=float, default=25, help="time of one render [default: 25]")
    parser.add_argument("--seeds", type=int, default=3, help="renders of each program in each scene [default: 3]")
    parser.add_argument("--threads", type=int, default=2, help="threads of every program [default: 2]")
    parser.add_argument(
        "--metrolight", type=Path, help="the binary [default: target/release/metrolight, built by cargo first]"
    )
    parser.add_argument(
        "--metrolight-integrators",
        type=_names,
        default=["path", "bdpt", "pssmlt", "mmlt"],
        help="Metrolight's integrators [default: path,bdpt,pssmlt,mmlt]",
    )
    parser.add_argument(
        "--reference-integrators",
        type=_names,
        default=["bdpt", "mmlt"],
        help="Metrolight's integrators that render candidates for the reference; the best is used [default: bdpt,mmlt]",
    )
    parser.add_argument(
        "--reference-seconds", type=float, default=240, help="time of each candidate in each scene [default: 240]"
    )
    parser.add_argument(
        "--references",
        type=Path,
        help="folder of references SCENE.npy or SCENE.exr of the right size, and for LuxCore in scenes with rough "
        "materials SCENE-luxcore; missing ones are rendered [default: OUTPUT/references]",
    )
    parser.add_argument(
        "--check-seconds",
        type=float,
        default=10,
        help="time of each render of step 2; 0 skips it. In less than 5 seconds LuxCore's Metropolis chains, one per "
        "thread, still depend on their start, and the check fails [default: 10]",
    )
    parser.add_argument(
        "--output", type=Path, default=REPOSITORY / "out" / "field", help="folder for all files [default: out/field]"
    )
    parser.add_argument("--resume", action="store_true", help="keep the rows of OUTPUT/field.csv and render the rest")
    parser.add_argument("--from-csv", type=Path, help="render nothing: make table and chart from this file")
    parser.add_argument(
        "--write", action="store_true", help="write table, chart and CSV into docs/ (performance.md, images/, field.csv)"
    )
    return parser.parse_args()


def _names(text):
    return text.split(",")


def main():
    options = arguments()
    options.output.mkdir(parents=True, exist_ok=True)
    options.output = options.output.resolve()
    table = options.from_csv
    if table is None:
        table = options.output / "field.csv"
        measure(options, table)
    present(table, options)


def measure(options, table):
    """Steps 1 to 4. The renderers are imported here, so that tables and charts do not require them."""
    import programs
    import results
    from agreement import SCENE, check

    if table.is_file() and not options.resume:
        raise Problem(f"{table} exists: remove it, or continue with --resume")
    binary = options.metrolight or build()
    if not binary.is_file():
        raise Problem(f"{binary} does not exist")
    unbiased = programs.metrolight(options.metrolight_integrators) + programs.LUXCORE + programs.MITSUBA
    field = unbiased + programs.LUXCORE_BIASED

    settings = {name: prepare(name, options, binary) for name in dict.fromkeys([*options.scenes, SCENE])}
    if options.check_seconds > 0:
        print(f"Do all programs render the same image of {SCENE}?", flush=True)
        reference_first = programs.metrolight(["bdpt"])
        others = [program for program in unbiased if program not in reference_first]
        check(reference_first + others, settings[SCENE][0], options.check_seconds)

    if not table.is_file():
        results.start(table)
    done = results.finished(results.read(table), budgets(options))
    references = {name: make_references(name, *settings[name], options) for name in options.scenes}
    for seed in range(options.seeds):
        for name in options.scenes:
            setting, rough = settings[name]
            for program in field:
                if (name, program.label, seed) in done:
                    continue
                own = rough and program.name == "LuxCore"
                reference = references[name]["luxcore" if own else "all"]
                rows = measure_one(name, program, setting, seed, options, reference)
                results.append(table, rows)
                last = rows[-1]
                print(
                    f"seed {seed} {name:15} {program.label:28} {last.seconds:6.2f} s, {last.samples:8.1f} spp, relMSE"
                    f" {last.relmse:.3g}, {last.relmse_trimmed_tenth:.3g}, {last.relmse_trimmed_two:.3g},"
                    f" mean {last.mean / last.reference_mean:.3f}",
                    flush=True,
                )


def budgets(options):
    """Seconds after which images are measured."""
    return [fraction * options.seconds for fraction in FRACTIONS]


def build():
    subprocess.run(["cargo", "build", "--release"], cwd=REPOSITORY, check=True)
    return REPOSITORY / "target" / "release" / "metrolight"


def prepare(name, options, binary):
    """Writes a scene for all programs; returns the setting, and whether LuxCore's materials differ from the others'."""
    import luxcore_scene
    import mitsuba_scene
    import scene
    from programs import Setting

    loaded = scene.load(REPOSITORY / "scenes" / name / "scene.xml", options.size)
    directory = options.output / "scenes" / name
    directory.mkdir(parents=True, exist_ok=True)
    mitsuba_scene.write(loaded, directory)
    luxcore_scene.write(loaded, directory)
    camera = loaded.camera
    setting = Setting(directory, camera.width, camera.height, options.threads, binary.resolve())
    return setting, loaded.has_rough_materials()


def make_references(name, setting, rough, options):
    """Metrolight renders the common reference; LuxCore renders its own where its materials differ from the others'."""
    import programs
    from references import find_or_make

    print(f"Reference of {name}", flush=True)
    directory = options.references or options.output / "references"
    candidates = programs.metrolight(options.reference_integrators)
    made = {"all": find_or_make(name, directory, candidates, setting, options.reference_seconds)}
    if rough:
        bidirectional = [program for program in programs.LUXCORE if program.integrator == "BIDIRCPU"]
        made["luxcore"] = find_or_make(
            f"{name}-luxcore", directory, bidirectional, setting, options.reference_seconds
        )
    return made


def measure_one(name, program, setting, seed, options, reference):
    import programs
    from errors import measure as measure_errors
    from results import Row

    times = budgets(options)
    rows = []
    for budget, frame in zip(times, programs.render(program, setting, seed, times)):
        errors = measure_errors(frame.image, reference.image)
        rows.append(
            Row(
                scene=name,
                program=program.name,
                integrator=program.integrator,
                sampler=program.sampler,
                seed=seed,
                threads=setting.threads,
                budget=budget,
                seconds=frame.seconds,
                samples=frame.samples,
                relmse=errors.relmse,
                relmse_trimmed_tenth=errors.trimmed_tenth,
                relmse_trimmed_two=errors.trimmed_two,
                mean=float(frame.image.mean(dtype=float)),
                reference_mean=float(reference.image.mean(dtype=float)),
                reference=reference.made_by,
                reference_error=reference.error,
            )
        )
    return rows


def present(table, options):
    """Step 5: table and chart."""
    import chart
    import results
    import tables

    rows = results.read(table)
    if not rows:
        raise Problem(f"{table} has no rows")
    text = tables.markdown(rows)
    (options.output / "field.md").write_text(text + "\n", encoding="utf-8")
    pictures = [options.output / "field.svg", options.output / "field.png"]
    chart.draw(rows, pictures)
    print(f"wrote {options.output / 'field.md'}, field.svg and field.png")
    if options.write:
        tables.insert(DOCUMENT, text)
        shutil.copyfile(pictures[0], CHART)
        if table.resolve() != TABLE:
            shutil.copyfile(table, TABLE)
        print(f"wrote {DOCUMENT}, {CHART} and {TABLE}")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("interrupted; continue with --resume")
    except Problem as problem:
        sys.exit(f"error: {problem}")
