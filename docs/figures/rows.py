"""Reads what benchmarks and the tool wrote: docs/figures/data."""
import csv
import json
import pathlib
import statistics

DATA = pathlib.Path(__file__).resolve().parent / "data"
MILLISECONDS = {"ns": 1e-6, "us": 1e-3, "ms": 1, "s": 1e3}


class Rows:
    """A file of Google Benchmark's: the median of each benchmark, by its name."""

    def __init__(self, file):
        self.name = file
        content = json.loads((DATA / file).read_text(encoding="utf-8"))
        self.context = content["context"]
        self.medians = {}
        runs = {}
        for row in content["benchmarks"]:
            name = row.get("run_name", row["name"]).removesuffix("/real_time")
            row["ms"] = row["real_time"] * MILLISECONDS[row["time_unit"]]
            if row.get("error_occurred"):
                continue
            if row.get("aggregate_name") == "median":
                self.medians[name] = row
            elif row.get("run_type") != "aggregate":
                runs.setdefault(name, []).append(row)
        for name, of in runs.items():
            middle = statistics.median_low(row["ms"] for row in of)
            self.medians.setdefault(name, next(row for row in of if row["ms"] == middle))

    def get(self, name, key="ms", scale=1):
        """A number, or None where it wasn't measured."""
        row = self.medians.get(name)
        return None if row is None or key not in row else row[key] * scale


def read_stats(file):
    """The report of a command's --stats, or None."""
    path = DATA / file
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else None


def read_errors():
    """{scene: {method: [(directions, seconds, error), …]}}, of skybark_gather_error."""
    scenes = {}
    with open(DATA / "gather_error.csv", encoding="utf-8") as file:
        for row in csv.DictReader(line for line in file if line.strip()):
            if row["scene"] == "scene":
                continue  # the header of a further table
            method = row["method"]
            if method.startswith("irradiance_cache"):
                method = "irradiance_cache" + ("_1024" if row["directions"] == "1024" else "")
            scenes.setdefault(row["scene"], {}).setdefault(method, []).append(
                (float(row["directions"]), float(row["seconds"]), float(row["error"])))
    return scenes
