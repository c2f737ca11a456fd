"""What errors are drawn against: passes, seconds by the clock or of processors, light paths or memory."""

from dataclasses import dataclass

MEBIBYTE = 2 ** 20


@dataclass(frozen=True)
class Axis:
    title: str          # with its unit
    columns: tuple      # of a curve or table, whose sum it is; "pass" is a curve's index
    unit: float = 1.0   # in units of the columns

    def of(self, curve):
        """The places of a curve, an array."""
        parts = [curve.index.to_series() if name == "pass" and name not in curve else curve[name] for name in self.columns]
        return sum(part.to_numpy(dtype=float) for part in parts) / self.unit


AXES = {"passes": Axis("pass", ("pass",)), "seconds": Axis("time of all passes so far (s)", ("seconds",)),
        "cpu_seconds": Axis("processor time of all passes so far (s)", ("cpu_seconds",)),
        "photons": Axis("light paths emitted", ("paths_emitted",)),
        "memory": Axis("photon map and hit points (MiB)", ("map_bytes", "hit_point_bytes"), MEBIBYTE)}
