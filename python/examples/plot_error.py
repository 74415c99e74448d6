"""Draws E(alpha), the error at arrival over the gain, of the paper's control and of a damped morph.

plot_error.py [PICTURE]: without a picture's name, in a window.
"""

import sys
from typing import Any

import matplotlib

if len(sys.argv) > 1:
    matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

import nuno

arch = {
    "arrival_time": 1,
    "initial": [[0, 1], [1, 1]],
    "target": [[3.0, 1.0], [3.2, 1.3], [3.5, 1.4], [3.8, 1.3], [4.0, 1.0]],
}
kinds: dict[str, tuple[dict[str, Any], float]] = {  # fields of the scene, and how far the gain goes, in gain scales
    "hold, as in the paper": ({}, 1e3),
    "damped morph": ({"reference": "morph", "damping_ratio": 0.7}, 1e5),
}

figure, axes = plt.subplots(figsize=(7, 4.2), layout="constrained")
for label, (fields, largest) in kinds.items():
    scene = nuno.make_scene(arch, **fields)
    backend = nuno.Backend(scene)
    alphas = np.geomspace(1, largest, 300) * backend.gain_scale
    errors = backend.errors(alphas)  # all flights at once
    best = nuno.optimize(scene)
    (line,) = axes.loglog(alphas, 100 * errors / scene.size, label=label)
    axes.plot(best.alpha, 100 * best.relative_error, "o", color=line.get_color())
axes.set(xlabel="gain α, N/m", ylabel="error at arrival, % of the cloth's length")
axes.grid(alpha=0.3)
axes.legend(frameon=False)
if len(sys.argv) > 1:
    figure.savefig(sys.argv[1], dpi=120)
else:
    plt.show()
