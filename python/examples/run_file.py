"""The input file of the command line: run, results, resume, compare, converge."""

import emmy

run = emmy.run("l-block.toml", set={"time.scheme": "DGM", "region.0.density": 2.5}, until=2.0, output="out")
run.summary["worst_energy_residual"], run.history["time"][-1], run.report   # dict, array, path of report.html
run.frames.times; run.frames[3].to_pyvista()
emmy.resume("out", until=4.0, step=0.02); emmy.compare(["out", "other"]); emmy.converge("l-block.toml", sizes=[.04, .02, .01]).order
