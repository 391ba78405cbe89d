"""The chart of the results: error against time, one panel per scene, one line per program."""

import matplotlib

matplotlib.use("agg")
import matplotlib.pyplot as plt
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from tables import in_order

COLUMNS = 4

# Height in inches of the legend, below all panels.
LEGEND = 1.0

# Axes whose limits have a ratio below this have ticks at 2 and 5 as well.
NARROW = 100

# The hue identifies the program (colours of Wong 2011, "Color blindness", Nature Methods 8), the line style and the
# marker identify the method.
STYLES = {
    "Metrolight path": ("#56b4e9", ":", "v"),
    "Metrolight bdpt": ("#0072b2", "--", "s"),
    "Metrolight pssmlt": ("#0072b2", "-", "o"),
    "Metrolight mmlt": ("#000000", "-", "D"),
    "LuxCore BIDIRCPU METROPOLIS": ("#d55e00", "-", "o"),
    "LuxCore BIDIRCPU SOBOL": ("#d55e00", "--", "s"),
    "LuxCore BIDIRCPU+roulette METROPOLIS": ("#cc79a7", "-", "o"),
    "LuxCore BIDIRCPU+roulette SOBOL": ("#cc79a7", "--", "s"),
    "LuxCore PATHCPU SOBOL": ("#e69f00", ":", "v"),
    "Mitsuba path": ("#009e73", ":", "^"),
}
OTHER_STYLE = ("#999999", "-", "x")


def draw(rows, paths):
    """Writes the chart to every path in `paths`, in the format given by the suffix."""
    scenes = in_order(row.scene for row in rows)
    labels = in_order(row.label for row in rows)
    columns = min(COLUMNS, len(scenes))
    lines = -(-len(scenes) // columns)
    figure, axes = plt.subplots(lines, columns, figsize=(3.1 * columns, 2.7 * lines + LEGEND), squeeze=False)
    for axis in axes.flat[len(scenes) :]:
        axis.set_visible(False)
    for axis, scene in zip(axes.flat, scenes):
        _panel(axis, [row for row in rows if row.scene == scene], scene)
    handles = [plt.Line2D([], [], label=label, **_look(label)) for label in labels]
    figure.supylabel("relMSE without the worst 0.1% of the pixels", fontsize=9)
    figure.tight_layout(rect=(0.01, LEGEND / (2.7 * lines + LEGEND), 1, 1))
    figure.legend(handles=handles, loc="lower center", ncols=3, fontsize=8, frameon=False)
    for path in paths:
        figure.savefig(path, dpi=110, metadata={"Date": None} if path.suffix == ".svg" else None)
    plt.close(figure)


def _look(label):
    colour, dash, mark = STYLES.get(label, OTHER_STYLE)
    return {"color": colour, "linestyle": dash, "marker": mark, "markersize": 3.5, "linewidth": 1.3}


def _panel(axis, rows, scene):
    """The line is the mean over the seeds; the band extends from the minimum to the maximum."""
    for label in in_order(row.label for row in rows):
        own = [row for row in rows if row.label == label]
        groups = [[row for row in own if row.budget == budget] for budget in sorted({row.budget for row in own})]
        seconds = [sum(row.seconds for row in group) / len(group) for group in groups]
        errors = [[row.relmse_trimmed_tenth for row in group] for group in groups]
        axis.plot(seconds, [sum(values) / len(values) for values in errors], **_look(label))
        colour = _look(label)["color"]
        axis.fill_between(seconds, [min(v) for v in errors], [max(v) for v in errors], color=colour, alpha=0.15, lw=0)
    axis.set_xscale("log")
    axis.set_yscale("log")
    axis.set_title(scene, fontsize=9)
    axis.set_xlabel("seconds", fontsize=8)
    budgets = sorted({row.budget for row in rows})
    axis.set_xticks(budgets, [f"{budget:.3g}" for budget in budgets])
    axis.xaxis.set_minor_formatter(NullFormatter())
    least, greatest = axis.get_ylim()
    axis.yaxis.set_major_locator(LogLocator(subs=(1, 2, 5) if greatest < NARROW * least else (1,), numticks=8))
    axis.yaxis.set_major_formatter(FuncFormatter(lambda value, _position: f"{value:g}"))
    axis.yaxis.set_minor_formatter(NullFormatter())
    axis.tick_params(labelsize=7)
    axis.grid(True, which="major", color="#dddddd", linewidth=0.6)
