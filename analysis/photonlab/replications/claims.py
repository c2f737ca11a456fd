"""What a number says of a claim, and what it says of the number that a page states.

A claim is true, false or, where the error is too large, neither (None). A verdict is about the claims of a row together. An error is
one standard error, NaN where it is not known: then the number is taken as it is, as the page does of one seed.
"""

import math
import re
from dataclasses import dataclass

HELD, IN_PART, DID_NOT_HOLD, CANNOT_TELL = "held", "held in part", "did not hold", "cannot tell"
REACH = 2.0    # standard errors within which two numbers are not told apart


@dataclass(frozen=True)
class Value:
    """A number with its standard error."""
    value: float
    error: float = math.nan

    def __str__(self):
        return f"{self.value:.4g}" + ("" if math.isnan(self.error) else f" ± {self.error:.2g}")

    @property
    def reach(self):
        return 0.0 if math.isnan(self.error) else REACH * self.error


def less(first, second):
    """Whether the first is less than the second, numbers or Values whose errors are independent or were taken together."""
    first, second = as_value(first), as_value(second)
    difference, reach = first.value - second.value, math.hypot(first.reach, second.reach)
    return None if math.isnan(difference) or abs(difference) <= reach else bool(difference < 0)


def near(found, expected, tolerance=0.0):
    """Whether a number is what is expected of it, to the tolerance or, where that is more, to its error."""
    found, expected = as_value(found), as_value(expected)
    difference = abs(found.value - expected.value)
    return None if math.isnan(difference) else bool(difference <= max(tolerance, math.hypot(found.reach, expected.reach)))


def as_value(number):
    return number if isinstance(number, Value) else Value(float(number))


def verdict(*claims):
    """Of all claims of a row: held where all are true, in part where some are."""
    if all(claim is True for claim in claims):
        return HELD
    if any(claim is True for claim in claims):
        return IN_PART
    return DID_NOT_HOLD if any(claim is False for claim in claims) else CANNOT_TELL


NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
STATED = re.compile(rf"(?P<value>{NUMBER})(?P<percent>%?)(?: ± (?P<error>{NUMBER})| \((?P<low>{NUMBER}) to (?P<high>{NUMBER})\))?")
AS_STATED, WITHIN_ERROR, OFF, NOT_STATED = "as stated", "within error", "off", ""


def stated(text, unit=1.0):
    """(Value, half a unit of its last digit) of the first number in a text of the page, or the first behind a colon: "0.32 ± 0.01",
    "-0.19 (-0.20 to -0.18)", an interval of 95%, "46%", "k 30: 8.5". `unit` is what the page counts in."""
    found = STATED.search(text.rpartition(": ")[2])
    if found["percent"]:
        unit = unit / 100
    error = math.nan
    if found["error"]:
        error = float(found["error"]) * unit
    elif found["low"]:
        error = (float(found["high"]) - float(found["low"])) / (2 * 1.96) * unit
    digits, _, power = found["value"].partition("e")
    half_digit = 0.5 * 10.0 ** (int(power or 0) - len(digits.partition(".")[2])) * unit
    return Value(float(found["value"]) * unit, error), half_digit


def agreement(found, text, unit=1.0):
    """What a number says of the one that the page states. Where the page has no error it is taken to be as uncertain as what was
    found; where neither has one, a tenth of the number."""
    if text is None:
        return NOT_STATED
    page, half_digit = stated(text, unit)
    difference = abs(found.value - page.value)
    if difference <= half_digit * 1.0001:
        return AS_STATED
    errors = [error for error in [found.error, page.error] if not math.isnan(error)]
    error = math.hypot(errors[0], errors[-1]) if errors else 0.1 * abs(page.value) / REACH
    return WITHIN_ERROR if difference <= REACH * error + half_digit else OFF
