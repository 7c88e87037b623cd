"""A device on a rubber mount under a half-sine of 30 g: stroke, shock response spectrum, transmissibility, pictures."""

import emmy
import numpy as np

rubber = emmy.NeoHookeIsochoric(mu=0.8, bulk_modulus=1000.0, volumetric="quadratic")
mesh = emmy.Mesh.box((40, 40, 20), cells=(4, 4, 3))
body = emmy.Body(
    mesh,
    emmy.Region(rubber, density=1.1e-9, formulation="projected-volume", viscosity=emmy.Viscosity(time=4e-4)),
    emmy.Support("z-min", fix="xy", accelerate={"z": "294200*half_sine(t, 0, 0.011)"}),
    masses=emmy.Mass("z-max", at=(20, 20, 50), mass=0.002, inertia=(1.2, 1.2, 1.2), name="device"),
)
top = {"point": (20, 20, 20), "quantities": ["acceleration"]}
stroke = {"point": (20, 20, 20), "quantities": ["displacement"], "relative_to": "base"}
motion = emmy.Motion(body, degree=2, steps=(0.2, 5e-4), probes={"plate": top, "stroke": stroke}, units="mm-t-s")
motion.run(output="shock-mount")                # the report, with the animation, is shock-mount/report.html

history = motion.history
print(f"stroke {np.abs(history['stroke_displacement_z']).max():.3f} mm")
print(f"acceleration of the device {np.nanmax(np.abs(history['plate_acceleration_z'])) / 9806.65:.1f} g")
felt = emmy.spectrum(history["time"], history["plate_acceleration_z"], kind="srs")
print(f"largest of the shock response spectrum {felt['acceleration_maximax'].max() / 9806.65:.0f} g")
shaken = emmy.response(body, np.linspace(5, 200, 391), base="z", quantity="acceleration", nodes=[mesh.nearest_node((20, 20, 20))])
amplitude = np.abs(shaken.amplitudes[:, 0, 2])
print(f"transmissibility {amplitude.max():.2f} at {shaken.frequencies[amplitude.argmax()]:.1f} Hz")

axes = emmy.plot.columns(motion, "stroke_displacement_z")
axes.figure.savefig("stroke.png")
