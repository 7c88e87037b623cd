"""The history of the book's quick start; run it where `emmy run first.toml` was run."""

import csv

with open("first/history.csv") as file:
    rows = list(csv.DictReader(file))
energies = [float(row["total_energy"]) for row in rows]
print(f"{len(rows) - 1} steps, T + V from {min(energies):.12f} to {max(energies):.12f}")
