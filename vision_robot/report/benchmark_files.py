"""A benchmark's tables for papers and programs: CSV and LaTeX."""

import csv
import io
from collections.abc import Iterable
from dataclasses import astuple, fields

import numpy as np

from vision_robot.evaluate.score import Score
from vision_robot.report.page import Table

__all__ = ["scores_csv", "table_csv", "table_latex"]

LATEX = {
    "\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{",
    "}": r"\}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": "$<$", ">": "$>$",
    "–": "--", "−": "$-$", "±": r"$\pm$", "µ": r"$\mu$", "°": r"$^\circ$",
}  # fmt: skip
"""What LaTeX would take for something else, or its fonts lack."""


def scores_csv(scores: Iterable[Score]) -> str:
    """Every score in a line, all digits; empty where there is no number."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow([field.name for field in fields(Score)])
    for score in scores:
        writer.writerow(["" if isinstance(v, float) and np.isnan(v) else v for v in astuple(score)])
    return text.getvalue()


def table_csv(table: Table) -> str:
    """A page's table as it is shown there."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([table.columns, *table.rows])
    return text.getvalue()


def table_latex(table: Table, *, label: str) -> str:
    """A page's table as a LaTeX table of the package booktabs, its caption included."""
    columns = "l" * len(table.columns)
    lines = [
        r"% \usepackage{booktabs}",
        r"\begin{table}",
        r"\centering",
        rf"\caption{{{escaped(table.caption)}}}",
        rf"\label{{{label}}}",
        rf"\begin{{tabular}}{{{columns}}}",
        r"\toprule",
        _row(table.columns),
        r"\midrule",
        *map(_row, table.rows),
        r"\bottomrule",
        r"\end{tabular}",
        r"\end{table}",
    ]
    return "\n".join(lines) + "\n"


def escaped(text: str) -> str:
    """Text that LaTeX sets as it stands."""
    return "".join(LATEX.get(letter, letter) for letter in text)


def _row(cells: Iterable[str]) -> str:
    return " & ".join(map(escaped, cells)) + r" \\"
