"""Throws a metre of cloth so that it arrives three metres away as an arch, after one second."""

import nuno

scene = nuno.make_scene(
    arrival_time=1,
    initial=[[0, 1], [1, 1]],  # points of a line: x, y
    target=[[3.0, 1.0], [3.2, 1.3], [3.5, 1.4], [3.8, 1.3], [4.0, 1.0]],
)

launch_only = nuno.simulate(scene)
flight = nuno.optimize(scene)

print(f"launch only: {launch_only.error:.6g} m from the target")
print(f"controlled:  {flight.error:.6g} m, at a gain of {flight.alpha:.6g} N/m")
print("frames, particles, dimension:", flight.frames.shape)
