"""Writes results as files: NAME.csv, NAME.md and figures, and several experiments as one HTML page and one PDF."""

import base64
import csv
import dataclasses
import html
import importlib.util
import math

from . import figures
from .experiment import Result, Table


@dataclasses.dataclass
class Report:
    name: str
    title: str
    result: Result
    circumstances: str

    @property
    def claims(self):
        return self.result.claims


def number(cell):
    """Digits that read back as the same double; nothing for NaN."""
    if isinstance(cell, str):
        return cell
    if math.isnan(cell):
        return ""
    text = repr(float(cell))
    return text[:-2] if text.endswith(".0") else text


def short(cell):
    return cell if isinstance(cell, str) else "" if math.isnan(cell) else f"{cell:.4g}"


def write_csv(table, path):
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([table.columns, *table.cells(number)])


def claims_of(result):
    return Table({"claim": c.statement, "holds": "yes" if c.held else "**no**", "measured": c.measured} for c in result.claims)


def files_of(report):
    """(file, caption) of each figure."""
    for figure in report.result.figures:
        yield f"{report.name}-{figure.suffix}.svg" if figure.suffix else f"{report.name}.svg", figure.caption


def markdown_table(table):
    lines = [table.columns, ["---"] * len(table.columns), *table.cells(short)]
    return "".join(f"| {' | '.join(line)} |\n" for line in lines) + "\n" if table else ""


def markdown(report):
    result = report.result
    text = f"# {report.name}: {report.title}\n\n" + "".join(f"{p}\n\n" for p in result.paragraphs)
    text += markdown_table(result.summary)
    text += "".join(f"![{caption}]({file})\n\n{caption}\n\n" for file, caption in files_of(report))
    text += markdown_table(claims_of(result))
    text += "".join(f"Data: `{file}` from the {origin}, SHA-256 `{sha256}`.\n\n" for file, sha256, origin in result.data)
    return text + f"All numbers: [{report.name}.csv]({report.name}.csv). {report.circumstances}\n"


def write_files(report, folder):
    write_csv(report.result.table, folder / f"{report.name}.csv")
    for figure, (file, _) in zip(report.result.figures, files_of(report)):
        figures.save(figure.drawn, (folder / file).with_suffix(""))
    (folder / f"{report.name}.md").write_text(markdown(report), encoding="utf-8")


def html_table(table):
    rows = [f"<th>{html.escape(name)}</th>" for name in table.columns], *(
        [f"<td>{html.escape(text).replace('**no**', '<b>NO</b>')}</td>" for text in texts] for texts in table.cells(short))
    return "<table>\n" + "".join(f"<tr>{''.join(row)}</tr>\n" for row in rows) + "</table>\n" if table else ""


def section(report, folder, whole):
    parts = [f'<h2 id="{report.name}">{report.name}: {html.escape(report.title)}</h2>\n',
             *(f"<p>{html.escape(text)}</p>\n" for text in report.result.paragraphs),
             html_table(report.result.summary)]
    for figure, (file, caption) in zip(report.result.figures, files_of(report)):
        # WeasyPrint 57 sets the text of such SVG in wrong sizes, so paper gets pixels.
        kind, data = ("svg+xml", (folder / file).read_bytes()) if whole else ("png", figures.pixels(figure.drawn))
        caption = html.escape(caption)
        parts.append(f'<figure><img src="data:image/{kind};base64,{base64.b64encode(data).decode()}" alt="{caption}">'
                     f"<figcaption>{caption}</figcaption></figure>\n")
    table = report.result.table
    numbers = (f"<details><summary>All numbers ({len(table)} rows)</summary>\n{html_table(table)}</details>\n" if whole else
               f"<p class=c>All {len(table)} rows of numbers are in {report.name}.csv.</p>\n")
    return "".join([*parts, html_table(claims_of(report.result)), numbers, f"<p class=c>{html.escape(report.circumstances)}</p>\n"])


METHOD = ("Each experiment asks a question and answers it with a table, figures and claims. A claim is a statement that the run checks, "
          "and it never depends on the speed of the machine. Everything random is seeded. Intervals are at 95 %: exact for shares, and "
          "by bootstrap for medians and ratios. The same command repeats a section.",)
THREATS = ("No person and no real device took part. Hands and devices are simulated, with constants that are partly assumed.",
           "The authors of the program chose the questions, the bodies and the claims. Known surfaces are smooth and few. Real scans are "
           "fewer still, and show heads and small objects.",
           "Intervals take cases as independent. Ticks of one hand depend on each other, so their number gives no bound.",
           "Other programs may share the machine. Times are medians of passes in which the methods take turns, so compare them within a "
           "table, and not between machines.",
           "Peers whose rows say (measured) were measured once, on one day and one machine, and are not run here.")


STYLE = ("body{font-family:'DejaVu Sans',sans-serif;max-width:64em;margin:2em auto;padding:0 1em;line-height:1.5}"
         "img{max-width:100%}figure{margin:1em 0;break-inside:avoid}figcaption,.c{color:#444;font-size:90%}"
         "table{border-collapse:collapse;font-size:85%}td,th{border:1px solid #ccc;padding:.2em .5em;text-align:left}"
         "h1,h2{break-after:avoid}tr{break-inside:avoid}details{overflow-x:auto}"
         "@page{size:A4;margin:18mm;@bottom-center{content:counter(page)}}"
         "@media print{body{max-width:none;margin:0;padding:0;font-size:9.5pt}table{font-size:7pt}img{max-height:190mm}}")


def page_of(reports, folder, whole=True):
    """HTML of all reports; `folder` holds the figures, which are embedded. whole: with the tables of all numbers."""
    entries = [f'<li><a href="#{r.name}">{r.name}</a>: {html.escape(r.title)} '
               f"({sum(c.held for c in r.claims)} of {len(r.claims)} claims hold)</li>\n" for r in reports]
    return ('<!DOCTYPE html>\n<html lang="en"><meta charset="utf-8">'
            f"<title>Palpate: the evidence</title>\n<style>{STYLE}</style>\n"
            f"<h1>Palpate: the evidence</h1>\n<ul>\n{''.join(entries)}</ul>\n<h2>Method</h2>\n"
            f"{''.join(f'<p>{text}</p>{chr(10)}' for text in METHOD)}"
            f"{''.join(section(report, folder, whole) for report in reports)}<h2>Threats to validity</h2>\n<ul>\n"
            f"{''.join(f'<li>{text}</li>{chr(10)}' for text in THREATS)}</ul>\n</html>\n")


def write_pages(reports, folder, into):
    """report.html, and report.pdf if WeasyPrint is there. Returns whether it is."""
    (into / "report.html").write_text(page_of(reports, folder), encoding="utf-8")
    if not importlib.util.find_spec("weasyprint"):
        return False
    import weasyprint
    weasyprint.HTML(string=page_of(reports, folder, whole=False)).write_pdf(into / "report.pdf")
    return True
