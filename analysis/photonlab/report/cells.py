"""Cells and tables in HTML. A cell is what is shown or, in a column of numbers, that with the number which it is sorted by."""

import math
from html import escape

import pandas

NOTHING = "–"
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def three_digits(value):
    """0.00331, −12.5, 6,400,000, 2.40·10⁻⁷."""
    if value == 0 or not math.isfinite(value):
        return f"{value:g}"
    if 1e-4 <= abs(value) < 1e3:
        return f"{value:#.3g}".rstrip(".").replace("-", "−")
    if 1e3 <= abs(value) < 1e12:
        return f"{value:,.0f}".replace("-", "−")
    mantissa, exponent = f"{value:.2e}".split("e")
    return f"{mantissa}·10{str(int(exponent)).translate(SUPERSCRIPTS)}".replace("-", "−")


def number(value, shown=None):
    return (NOTHING if math.isnan(value) else shown or three_digits(value), value)


def cells(texts):
    """A column of a CSV: numbers where all that is not empty is one, as they were written where all are short."""
    values = pandas.to_numeric(texts, errors="coerce")
    if (values.isna() & ~texts.str.lower().isin(["", "nan", "-nan"])).any():
        return list(texts)
    short = texts.str.len().max() <= 6
    return [number(value, text.replace("-", "−") if short else None) for value, text in zip(values, texts)]


def whole(value):
    return number(value, f"{value:,.0f}")


def least(rows, groups, columns):
    """{(row, column)} of the cells whose number is the nearest to 0 in a column among the rows of the same group, where there are
    several; `groups` has that of each row. What is shown alike is marked alike, and 0 is below what can be told."""
    found = set()
    for column in columns:
        for group in set(groups):
            known = [place for place, of in enumerate(groups) if of == group and abs(rows[place][column][1]) > 0]
            shown = {rows[place][column][0] for place in known}
            if len(shown) > 1:
                best = rows[min(known, key=lambda place: abs(rows[place][column][1]))][column][0]
                found |= {(place, column) for place in known if rows[place][column][0] == best}
    return found


def table(caption, note, groups, columns, rows, marked=frozenset()):
    """A sortable table. `note` is small print after the caption; `groups` are (heading, how many columns it spans)
    above the columns, or nothing. A row's cells are texts, or pairs of text and number; `marked` are (row, column) of the best."""
    numeric = [any(isinstance(row[place], tuple) for row in rows) for place in range(len(columns))]

    def body_cell(row, column, cell):
        if not isinstance(cell, tuple):
            return f"<td>{escape(cell)}</td>"
        shown, value = cell
        kind = "number words" if " " in shown else "number"
        if (row, column) in marked:
            kind += f' best" aria-label="{escape(shown)}, the best'
        return f'<td class="{kind}" data-value="{"" if math.isnan(value) else repr(float(value))}">{escape(shown)}</td>'

    above = "".join(f'<th colspan="{span}"{" class=group" if heading else ""}>{escape(heading)}</th>'
                    for heading, span in groups)
    heads = "".join(f'<th scope="col"{" class=number" if is_number else ""}><button type="button">'
                    f'{escape(name).replace("_", "_<wbr>")}</button></th>' for name, is_number in zip(columns, numeric))
    lines = "\n".join(f"<tr>{''.join(body_cell(place, column, cell) for column, cell in enumerate(row))}</tr>"
                      for place, row in enumerate(rows))
    return (f'<div class="wide"><table class="sortable"><caption>{escape(caption)}'
            f'{f"<span>{escape(note)}</span>" if note else ""}</caption>\n<thead>'
            f"{f'<tr>{above}</tr>' if above else ''}<tr>{heads}</tr></thead>\n<tbody>\n{lines}\n</tbody></table></div>")
