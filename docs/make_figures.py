"""Makes the tables and charts of docs/ from what the tests measured: see docs/prove.sh.

    python3 docs/make_figures.py            # prints the tables
    pip install -r docs/requirements.txt
    python3 docs/make_figures.py --write    # writes them, and charts, into docs/

The rows that the tests recorded are in target/figures/TABLE.jsonl. Each table is written into the document
between the lines `<!-- TABLE -->` and `<!-- end -->`, and the charts into docs/images/.
"""

import json
import re
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
FIGURES = HERE.parent / "target" / "figures"

COLOURS = {"path": "#0072b2", "bdpt": "#d55e00", "pssmlt": "#009e73"}

SWEEPS = {
    "lamp": ("A lamp in a room", "area of the lamp"),
    "lamp-over-glass": ("A lamp over a glass ball", "area of the lamp"),
    "lamp-behind-two-panes": ("A lamp behind two panes", "area of the lamp"),
    "roughness": ("A ball of rough glass", "roughness alpha (right end: smooth)"),
    "slit": ("Light through a slit", "width of the slit"),
}


def rows(table):
    path = FIGURES / f"{table}.jsonl"
    lines = path.read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def markdown(header, cells):
    """A Markdown table; line breaks and bars in cells are replaced or escaped."""
    clean = [[str(cell).replace("|", "\\|").replace("\n", " ") for cell in row] for row in cells]
    lines = [header, ["---"] * len(header), *clean]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def insert(document, name, text):
    """Replaces the text between the marks of `name` in a document."""
    path = HERE / document
    old = path.read_text(encoding="utf-8")
    mark = re.compile(rf"(<!-- {re.escape(name)} -->\n).*?(<!-- end -->)", re.DOTALL)
    new, count = mark.subn(lambda match: f"{match[1]}\n{text}\n\n{match[2]}", old)
    if count != 1:
        raise SystemExit(f"{path}: one mark <!-- {name} --> is required, found {count}")
    path.write_text(new, encoding="utf-8")


def accuracy():
    """The tables of docs/accuracy.md, one per oracle (source of expected values)."""
    by_oracle = {}
    for row in rows("accuracy"):
        by_oracle.setdefault(row["oracle"], []).append(row)
    tables = {}
    for oracle, found in sorted(by_oracle.items()):
        # The tests ran concurrently, so the order of their rows is arbitrary.
        found.sort(key=lambda row: row["case"])
        cells = [(row["case"], row["found"], row["demanded"]) for row in found]
        tables[oracle] = markdown(["case", "measured", "criterion"], cells)
    return tables


def stability():
    """The table of docs/stability.md."""
    found = sorted(rows("stability"), key=lambda row: (row["case"], row["method"]))
    cells = [(row["case"], row["method"], row["happens"], row["told"]) for row in found]
    header = ["case", "method", "what happens", "what the user is told"]
    return {"stability": markdown(header, cells)}


def sweeps():
    """Charts of the error, and of the fraction of light that is found, against the parameter of each sweep."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams["svg.hashsalt"] = "metrolight"
    found = rows("sweeps")
    for sweep, (title, label) in SWEEPS.items():
        figure, (error, share) = plt.subplots(1, 2, figsize=(9, 3.4), layout="constrained")
        of_sweep = [row for row in found if row["sweep"] == sweep]
        smallest = min(row["parameter"] for row in of_sweep if row["parameter"] > 0)
        for method, colour in COLOURS.items():
            points = sorted(
                (row["parameter"] or smallest / 10, row["relative_mse"], row["found"], row["found_error"])
                for row in of_sweep
                if row["integrator"] == method
            )
            x, relative_mse, light, light_error = zip(*points)
            error.loglog(x, relative_mse, "o-", color=colour, label=method, markersize=3)
            share.errorbar(x, light, light_error, fmt="o-", color=colour, label=method, markersize=3)
        share.set_xscale("log")
        share.set_ylim(0, max(1.5, min(3, max(row["found"] for row in of_sweep) * 1.1)))
        share.axhline(1, color="grey", linewidth=0.8)
        error.set_ylabel("relMSE at 64 samples per pixel")
        share.set_ylabel("mean of the image / reference")
        for axes in (error, share):
            axes.set_xlabel(label)
            axes.invert_xaxis()
            axes.grid(True, which="major", linewidth=0.3)
        error.legend(frameon=False)
        figure.suptitle(title)
        path = HERE / "images" / f"sweep-{sweep}"
        figure.savefig(path.with_suffix(".svg"), metadata={"Date": None})
        figure.savefig(path.with_suffix(".png"), dpi=110)
        plt.close(figure)


def main():
    documents = {"accuracy.md": accuracy(), "stability.md": stability()}
    if sys.argv[1:] == ["--write"]:
        for document, tables in documents.items():
            for name, table in tables.items():
                insert(document, name, table)
        sweeps()
    else:
        for tables in documents.values():
            for name, table in tables.items():
                print(f"\n{name}\n\n{table}")


if __name__ == "__main__":
    main()
