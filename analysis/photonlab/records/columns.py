"""What the columns of the records mean. The program says it beside them, in columns.json: of each column whether it is a setting, a
measure, a time or an identity, its unit and how it is named. So what the program has a new line for (a setting, a metric, an
integrator) is labelled, drawn and tabled here without a line more.

columns_of_schema_1.json describes results that were written before folders described themselves. Such results are not written any
more, so it never changes; it is used where a folder has no columns.json.

A column that is not described is kept, and is a setting where it tells points apart (methods.py). A column that is described and is
not in the table has the text that its description names.
"""

from dataclasses import dataclass, field
from pathlib import Path

from photonlab.records import files, kept_files
from photonlab.records.files import InputError

SCHEMA = 1
BEFORE_DESCRIPTIONS = Path(__file__).with_name("columns_of_schema_1.json")
KINDS = ["identity", "setting", "measure", "time"]
TYPES = ["text", "integer", "number"]
ADVICE = "run the experiment again, which writes it anew"


@dataclass(frozen=True)
class Column:
    name: str
    kind: str = "setting"    # identity; setting: makes a method; measure; time
    type: str = "text"
    label: str = ""          # how labels and axes name it; empty: its values say what it is
    unit: str = ""
    default: str = ""        # what stands in a table without this column,
    used_by: tuple = ()      # in rows of these integrators; in all where none is named
    follows: tuple = ()      # settings from which it follows: it is no knob where one of them was turned
    values: dict = field(default_factory=dict)    # of a choice, in the order of legends: how each is shown
    error: bool = False      # a metric: the distance from the reference

    def shown(self, text):
        """How a label shows a value: "PPM", "0.7", "12.35" for 12.345678901."""
        number = as_number(text)
        return self.values.get(text, text) if number is None or len(text) <= 7 else f"{number:.4g}"

    def rank(self, text):
        """By which values are in the order of legends: none, then numbers, then choices in their order, then other texts."""
        if text in self.values:
            return 1, list(self.values).index(text), ""
        number = as_number(text)
        return (-1, 0.0, "") if text == "" else (0, number, "") if number is not None else (2, 0.0, text)


class Columns:
    """The columns of a table, in its order."""

    def __init__(self, described):
        self.by_name = {column.name: column for column in described}

    def __getitem__(self, name):
        """The column of that name; a setting that is named as it is called where it is not described."""
        return self.by_name.get(name) or Column(name, label=name.replace("_", " "))

    def __contains__(self, name):
        return name in self.by_name

    def __iter__(self):
        return iter(self.by_name.values())

    def of_kind(self, *kinds):
        return [column.name for column in self if column.kind in kinds]

    @property
    def settings(self):
        """What makes a method, in the order in which a label names it."""
        return self.of_kind("setting")

    @property
    def table_settings(self):
        """What tables say of a method."""
        return [*self.settings, "threads"]

    @property
    def metrics(self):
        return [column for column in self if column.error]

    def setting_text(self, name, value):
        """How a label names a setting: "PPM", "α = 0.7", "max depth = 5"."""
        column = self[name]
        return f"{column.label} = {column.shown(value)}" if column.label else column.shown(value)

    def name_of(self, name):
        """How a sentence names a setting: "α", "kernel"."""
        return self[name].label or name.replace("_", " ")

    def axis_text(self, name):
        """How an axis names it, with its unit: "α", "initial radius (scene units)"."""
        unit = self[name].unit
        return self.name_of(name) + (f" ({unit})" if unit else "")


def as_number(text):
    try:
        return float(text)
    except ValueError:
        return None


def read_columns(folder):
    """The columns of a results folder's records."""
    file = Path(folder) / "columns.json"
    return columns_in(file, kept_files.read_json(file, ADVICE, must_be_checked=True)) if files.is_there(file) else before_descriptions()


def before_descriptions():
    """The columns of results from before they described themselves."""
    return columns_in(BEFORE_DESCRIPTIONS, files.read_json(BEFORE_DESCRIPTIONS))


def columns_in(file, description):
    """Columns from JSON, checked."""
    listed = description.get("columns") if isinstance(description, dict) else None
    if not isinstance(listed, list) or description.get("schema") != SCHEMA:
        raise InputError(f"{file}: expected \"schema\", {SCHEMA}, and \"columns\", a list")
    columns = [column_in(file, place, entry) for place, entry in enumerate(listed, 1)]
    found = Columns(columns)
    if len(found.by_name) < len(columns):
        raise InputError(f"{file}: names a column twice")
    return found


def are_texts(value):
    return isinstance(value, list) and all(isinstance(text, str) for text in value)


# What an entry of columns.json has, and what each must be.
ENTRY = {
    "name": (lambda value: isinstance(value, str) and value, "a name"),
    "kind": (lambda value: value in KINDS, f"one of {', '.join(KINDS)}"),
    "type": (lambda value: value in TYPES, f"one of {', '.join(TYPES)}"),
    "label": (lambda value: isinstance(value, str), "a text"),
    "unit": (lambda value: isinstance(value, str), "a text"),
    "default": (lambda value: isinstance(value, str), "a text"),
    "used_by": (are_texts, "a list of integrators"),
    "follows": (are_texts, "a list of names"),
    "values": (lambda value: isinstance(value, list) and all(are_texts(pair) and len(pair) == 2 for pair in value),
               "a list of pairs, a value and how it is shown"),
    "error": (lambda value: isinstance(value, bool), "true or false"),
}


def column_in(file, place, entry):
    """Column number `place` of the list. What an entry does not have is as in Column."""
    if not isinstance(entry, dict) or not {"name", "kind", "type"} <= set(entry):
        raise InputError(f"{file}: column {place}: expected an object with name, kind and type")
    known = {key: value for key, value in entry.items() if key in ENTRY}
    for key, value in known.items():
        is_sound, expected = ENTRY[key]
        if not is_sound(value):
            raise InputError(f"{file}: column {place}: {key}: expected {expected}")
    as_in_column = {"follows": tuple, "used_by": tuple, "values": dict}
    return Column(**{key: as_in_column[key](value) if key in as_in_column else value for key, value in known.items()})
