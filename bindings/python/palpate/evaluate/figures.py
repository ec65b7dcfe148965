"""How figures look: for print at the width of one or two columns, in colours that color-blind readers can tell apart (Okabe and Ito),
with labels at the curves. The same numbers give the same file."""

import io
import re

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot  # noqa: E402
import numpy  # noqa: E402

COLUMN, PAGE = 3.5, 7.1  # widths [inch]
BLUE, VERMILION, GREEN = "#0072B2", "#D55E00", "#009E73"
PURPLE, ORANGE, SKY, BLACK, GREY = "#CC79A7", "#E69F00", "#56B4E9", "#000000", "#707070"
# A method looks the same in all figures: colour and marker.
LOOKS = {"exact": (BLUE, "o"), "paper": (GREEN, "s"), "gradient": (VERMILION, "^"),
         "gradient-improved": (ORANGE, "v"), "smooth": (PURPLE, "D")}

matplotlib.rcParams.update({
    "font.size": 8, "font.family": "DejaVu Sans", "axes.titlesize": 8.5, "axes.labelsize": 8,
    "axes.titleweight": "bold", "axes.titlelocation": "left", "axes.spines.top": False,
    "axes.spines.right": False, "axes.grid": True, "grid.color": "#e4e4e4", "grid.linewidth": 0.6,
    "axes.axisbelow": True, "xtick.labelsize": 7.5, "ytick.labelsize": 7.5, "lines.linewidth": 1.4,
    "lines.markersize": 4, "figure.constrained_layout.use": True, "savefig.dpi": 200,
    "svg.hashsalt": "palpate", "svg.fonttype": "none", "pdf.fonttype": 42, "figure.titlesize": 9,
    "figure.titleweight": "bold"})


def panels(rows=1, columns=1, height=2.6, width=None, title=None, **settings):
    """A figure and its axes, as wide as a column of a page, or a page for several panels."""
    drawn, axes = matplotlib.pyplot.subplots(
        rows, columns, figsize=(width or (COLUMN if columns == 1 else PAGE), height), **settings)
    if title:
        drawn.suptitle(title, x=0.01, ha="left")
    return drawn, axes


def curve(axes, name, x, y, **look):
    """A contestant's curve in its colour and marker."""
    colour, marker = LOOKS[name]
    axes.plot(x, y, **{"color": colour, "marker": marker, "label": name, **look})


def ticks(axis, places, labels=None):
    """Ticks of axes.xaxis or axes.yaxis at these places only, with their numbers or with names."""
    axis.set_ticks(places, [f"{place:g}" for place in places] if labels is None else labels)
    axis.set_ticks([], minor=True)


def limit(axes, value, text, ls="--"):
    """A line across a panel at a bound, with its name."""
    axes.axhline(value, color=GREY, ls=ls, lw=0.8)
    axes.text(0.01, value, text, transform=axes.get_yaxis_transform(), color=GREY, fontsize=6.5, va="bottom")


def names(axes, entries, x=1.03, top=0.98, apart=0.1, **look):
    """(name, colour) below one another, from a place in parts of the panel."""
    for number, (name, colour) in enumerate(entries):
        axes.text(x, top - apart * number, name, color=colour, transform=axes.transAxes, **{"fontsize": 7.5, "va": "top", **look})


def number_map(axes, values, rows, columns, darkest, form="{:.0f}", fontsize=6.5):
    """A matrix as numbers on shades of blue, with names of its rows and columns."""
    axes.imshow(values, cmap="Blues", vmin=0, vmax=darkest, aspect="auto")
    for (row, column), value in numpy.ndenumerate(numpy.array(values)):
        axes.text(column, row, form.format(value), ha="center", va="center", fontsize=fontsize)
    ticks(axes.xaxis, range(len(columns)), columns)
    ticks(axes.yaxis, range(len(rows)), rows)
    axes.grid(False)


def label_ends(*panels, apart=0.075):
    """Writes each curve's label at its right end, in its colour, pushed apart where ends meet, and a thin line to it where it was pushed
    away."""
    panels[0].figure.canvas.draw()  # before any label, as labels move the panels
    for axes in panels:
        ends = []
        for line in axes.get_lines():
            shown = line.get_xydata()[numpy.isfinite(line.get_xydata()).all(axis=1)]
            if len(shown) and not line.get_label().startswith("_"):
                ends.append(((axes.transData - axes.transAxes).transform(shown[-1]), line))
        ends.sort(key=lambda end: end[0][1])
        below = apart * numpy.arange(len(ends))
        heights = numpy.maximum.accumulate([height for (_, height), _ in ends] - below) + below
        heights = numpy.maximum(heights - max(0, heights.max(initial=0) - 1), below)
        for (at, line), height in zip(ends, heights):
            axes.annotate(line.get_label(), at, (1.05, height), xycoords="axes fraction", textcoords="axes fraction", va="center",
                          color=line.get_color(), fontsize=7.5, annotation_clip=False,
                          arrowprops={"arrowstyle": "-", "color": line.get_color(), "lw": 0.5, "shrinkA": 0, "shrinkB": 2,
                                      "relpos": (0, 0.5)})


def compact(svg):
    """Matplotlib's SVG in fewer bytes: places to a hundredth of a point, and no indents."""
    def rounded(places):
        return re.sub(r"-?\d+\.\d+", lambda number: f"{round(float(number[0]), 2) + 0:.10g}", places[0].replace("\n", ""))

    return re.sub(r' (d|x|y)="[^"]*"|translate\([^)]*\)', rounded, re.sub(r"\n +", "\n", svg))


def save(figure, path):
    """As SVG and PDF, without a date; `path` has no ending."""
    drawn = io.StringIO()
    figure.savefig(drawn, format="svg", metadata={"Date": None})
    path.with_name(path.name + ".svg").write_text(compact(drawn.getvalue()), encoding="utf-8")
    figure.savefig(path.with_name(path.name + ".pdf"), metadata={"CreationDate": None})
    matplotlib.pyplot.close(figure)

