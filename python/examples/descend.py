"""Finds gains for long waves and for the rest with scipy, from the exact derivatives.

Both are searched by their logarithm, x = log(alpha), so that they stay positive:
dE/dx = alpha * dE/dalpha.
"""

import numpy as np
import numpy.typing as npt
import scipy.optimize

import nuno

scene = nuno.make_scene(
    arrival_time=1,
    initial=[[0, 1], [1, 1]],
    target=[[3.0, 1.0], [3.2, 1.3], [3.5, 1.4], [3.8, 1.3], [4.0, 1.0]],
)
backend = nuno.Backend(scene)
single = nuno.optimize(scene)


def error_and_slope(x: npt.NDArray[np.float64]) -> tuple[float, npt.NDArray[np.float64]]:
    alphas = np.exp(x)
    errors, gradients = backend.gradients([alphas])  # one flight, two gains
    return float(errors[0]), alphas * gradients[0]


start = np.log([single.alpha, single.alpha])
found = scipy.optimize.minimize(error_and_slope, start, jac=True, method="L-BFGS-B",
                                bounds=[(x - 5, x + 5) for x in start])

percent = 100 / scene.size
print(f"one gain:  {percent * single.error:.4f} %, alpha = {single.alpha:.4g} N/m")
print(f"two gains: {percent * found.fun:.4f} %, alpha =", np.exp(found.x), "N/m,",
      found.nfev, "flights with gradients")
assert found.fun <= single.error * (1 + 1e-9)
