"""Writes results as files: NAME.csv, NAME.md and figures, and several experiments as one HTML page and one PDF."""

import base64
import collections
import csv
import functools
import html
import importlib.util
import io
import math
import re
import string
from pathlib import Path

from . import figures
from .experiment import Table


Report = collections.namedtuple("Report", "name title result circumstances")


def number(cell, digits=12):
    """To more digits than other compilers repeat; nothing for NaN."""
    return cell if isinstance(cell, str) else "" if math.isnan(cell) else f"{cell:.{digits}g}"


short = functools.partial(number, digits=4)


def write_csv(table, path):
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([table.columns, *table.cells(number)])


def claims_of(result):
    return Table({"claim": c.statement, "holds": "yes" if c.held else "**no**", "measured": c.measured} for c in result.claims)


def data_of(result):
    return [f"Data: `{file}` from the {origin}, SHA-256 `{sha256}`." for file, sha256, origin in result.data]


def files_of(report):
    """(file, caption) of each figure."""
    for figure in report.result.figures:
        yield f"{report.name}-{figure.suffix}.svg" if figure.suffix else f"{report.name}.svg", figure.caption


def in_place_of_a_picture(caption):
    """Its first sentence. The caption stands below the picture and need not be read out twice."""
    return caption.partition(". ")[0].rstrip(".")


def markdown_table(table):
    lines = [table.columns, ["---"] * len(table.columns), *table.cells(short)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines) + "\n" if table else ""


def markdown(report):
    result = report.result
    text = f"# {report.name}: {report.title}\n\n" + "".join(f"{p}\n\n" for p in result.paragraphs)
    text += markdown_table(result.summary)
    text += "".join(f"![{in_place_of_a_picture(caption)}]({file})\n\n{caption}\n\n" for file, caption in files_of(report))
    text += markdown_table(claims_of(result))
    text += "".join(f"{line}\n\n" for line in data_of(result))
    return text + f"All numbers: [{report.name}.csv]({report.name}.csv). {report.circumstances}\n"


def write_files(report, folder):
    write_csv(report.result.table, folder / f"{report.name}.csv")
    for figure, (file, _) in zip(report.result.figures, files_of(report)):
        figures.save(figure.drawn, (folder / file).with_suffix(""))
    (folder / f"{report.name}.md").write_text(markdown(report), "utf-8", "surrogateescape")


def html_table(table):
    """Its first row comes again on each page of paper."""
    head = "".join(f"<th>{html.escape(name)}</th>" for name in table.columns)
    rows = ("".join(f"<td>{html.escape(text).replace('**no**', '<b>NO</b>')}</td>" for text in texts) for texts in table.cells(short))
    return f"<table>\n<thead><tr>{head}</tr></thead>\n" + "".join(
        f"<tr>{row}</tr>\n" for row in rows) + "</table>\n" if table else ""


def small(text):
    return "<p class=c>" + re.sub("`(.*?)`", r"<code>\1</code>", html.escape(text)) + "</p>\n"


def section(report, folder, whole):
    parts = [f'<h2 id="{report.name}">{report.name}: {html.escape(report.title)}</h2>\n',
             *(f"<p>{html.escape(text)}</p>\n" for text in report.result.paragraphs),
             html_table(report.result.summary)]
    for figure, (file, caption) in zip(report.result.figures, files_of(report)):
        kind, data = "svg+xml", (folder / file).read_bytes()
        if not whole:  # WeasyPrint 57 sets the text of such SVG in wrong sizes, so paper gets pixels
            figure.drawn.savefig(pixels := io.BytesIO(), format="png")
            kind, data = "png", pixels.getvalue()
        alt = html.escape(in_place_of_a_picture(caption))
        parts.append(f'<figure><img style="width:{figure.drawn.get_figwidth():g}in" alt="{alt}" '
                     f'src="data:image/{kind};base64,{base64.b64encode(data).decode()}">'
                     f"<figcaption>{html.escape(caption)}</figcaption></figure>\n")
    table = report.result.table
    numbers = (f"<details><summary>All numbers ({len(table)} rows)</summary>\n{html_table(table)}</details>\n" if whole else
               small(f"All {len(table)} rows of numbers are in {report.name}.csv."))
    return "".join([*parts, html_table(claims_of(report.result)), numbers, *map(small, data_of(report.result))])



def page_of(reports, folder, whole=True):
    """HTML of all reports; `folder` holds the figures, which are embedded. whole: with the tables of all numbers."""
    page = string.Template((Path(__file__).parent / "pages" / "report.html").read_text(encoding="utf-8"))
    held = [claim.held for report in reports for claim in report.result.claims]
    # A paragraph for all of them, or one for those that share a machine, a moment and a build.
    shared = {text: [r.name for r in reports if r.circumstances == text] for text in (r.circumstances for r in reports)}
    circumstances = [small(text if len(shared) == 1 else f"{', '.join(names)}: {text}") for text, names in shared.items()]
    return page.substitute(sections="".join(section(report, folder, whole) for report in reports), held=sum(held), claims=len(held),
                           circumstances="".join(circumstances), entries="".join(
        f'<li><a href="#{r.name}">{r.name}</a>: {html.escape(r.title)} '
        f"({sum(c.held for c in r.result.claims)} of {len(r.result.claims)} claims hold)</li>\n" for r in reports))


def write_pages(reports, folder, into):
    """report.html, and report.pdf if WeasyPrint is there. Returns whether it is."""
    (into / "report.html").write_text(page_of(reports, folder), "utf-8", "surrogateescape")
    if not importlib.util.find_spec("weasyprint"):
        return False
    import weasyprint
    weasyprint.HTML(string=page_of(reports, folder, whole=False)).write_pdf(into / "report.pdf")
    return True
