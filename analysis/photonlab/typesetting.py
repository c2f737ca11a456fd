"""Tables of text for people: in a terminal, in Markdown, and in LaTeX with the rules of booktabs."""

import re
import unicodedata

KINDS = ["text", "markdown", "latex"]
IN_LATEX = {"\\": r"\textbackslash{}", **{letter: f"\\{letter}" for letter in "&%$#_{}"}, "~": r"\textasciitilde{}",
            "^": r"\textasciicircum{}", "±": r"$\pm$", "−": r"$-$", "×": r"$\times$", "·": r"$\cdot$", "²": r"$^2$",
            "≤": r"$\leq$", "√": r"$\surd$", "–": "--", "<": r"$<$", ">": r"$>$"}
NUMBER = re.compile(r"[-−+]?[\d.,]+(e[-+]?\d+)?( ± [\d.,e+-]+)?%?")


def table(kind, columns, rows):
    """Rows of texts under the names of columns. Columns of numbers are set to the right."""
    right = [any(row[place] for row in rows) and all(not row[place] or NUMBER.fullmatch(row[place]) for row in rows)
             for place in range(len(columns))]
    return {"text": as_text, "markdown": as_markdown, "latex": as_latex}[kind](columns, rows, right)


def width_of(text):
    """In cells of a terminal."""
    return sum(0 if unicodedata.combining(letter) else 2 if unicodedata.east_asian_width(letter) in "WF" else 1 for letter in text)


def as_text(columns, rows, right):
    widths = [max(map(width_of, column)) for column in zip(columns, *rows)]

    def line(cells):
        padded = [" " * (width - width_of(cell)) + cell if at_right else cell + " " * (width - width_of(cell))
                  for cell, width, at_right in zip(cells, widths, right)]
        return "  ".join(padded).rstrip()
    return "\n".join([line(columns), "  ".join("-" * width for width in widths), *map(line, rows)])


def as_markdown(columns, rows, right):
    def line(cells):
        return f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"
    return "\n".join([line(columns), f"|{'|'.join(' ---: ' if at_right else ' --- ' for at_right in right)}|", *map(line, rows)])


def in_latex(text):
    """Greek letters as mathematics, whatever LaTeX reads the file."""
    def letter(one):
        name = unicodedata.name(one, "")
        return f"$\\{name.split()[-1].lower()}$" if name.startswith("GREEK SMALL LETTER") else IN_LATEX.get(one, one)
    return "".join(map(letter, text))


def as_latex(columns, rows, right):
    lines = [" & ".join(map(in_latex, cells)) + r" \\" for cells in [columns, *rows]]
    return "\n".join([rf"\begin{{tabular}}{{{''.join('r' if at_right else 'l' for at_right in right)}}}", r"\toprule", lines[0],
                      r"\midrule", *lines[1:], r"\bottomrule", r"\end{tabular}"])
