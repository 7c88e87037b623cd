"""Energy balance, deflection and period of the bracket; run it where `emmy run bracket.toml` was run."""

import csv

with open("bracket/history.csv") as file:
    rows = [{key: float(value or "nan") for key, value in row.items()} for row in csv.DictReader(file)]

free = [row for row in rows if row["time"] >= 2e-4]
work = free[-1]["external_work"]
drift = max(abs(row["total_energy"] - row["external_work"]) for row in free)
print(f"work of the blow: {work:.3f} mJ; T + V differs from it by at most {drift / work:.1e} of it")

start = rows[0]["tip_x"]
deflection = [(row["time"], row["tip_x"] - start) for row in rows]
time, lowest = min(deflection, key=lambda point: point[1])
print(f"largest deflection: {-lowest:.3f} mm at {1e3 * time:.2f} ms")

# Zero crossings on the way back: one in each period.
pairs = zip(deflection, deflection[1:])
crossings = [a[0] - a[1] * (b[0] - a[0]) / (b[1] - a[1]) for a, b in pairs if a[1] < 0 <= b[1]]
period = (crossings[-1] - crossings[0]) / (len(crossings) - 1)
print(f"period: {1e3 * period:.2f} ms")
