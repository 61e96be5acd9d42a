"""The least wood of a small tree whose topology stands, by SciPy's Powell search, which the paper uses.

The same tree is in src/variational/update.rs, which must end no higher. Needs scipy:

    python tests/powell.py
"""

import numpy as np
import scipy
from scipy.optimize import minimize

# A trunk of nodes 1 to 4 above the root, a branch 5 to 8 on each, and 40 shape nodes hung on all eight in turn.
PARENTS = [0, 0, 1, 2, 3, 1, 2, 3, 4]
PLACES = np.array([[i * 7 % 11 - 5, 3 + i * 5 % 13 * 0.5, i * 3 % 7 - 3] for i in range(40)], float)
OWNERS = np.array([1 + i % 8 for i in range(40)])
START = np.array([[0.25 * i, i, -0.25 * i] for i in range(1, 9)], float)

flows = np.bincount(OWNERS, minlength=9).astype(float)
for node in range(8, 0, -1):
    flows[PARENTS[node]] += flows[node]
THICK = flows ** (2.0 / 2.5)


def wood(flat):
    nodes = np.vstack([np.zeros(3), flat.reshape(-1, 3)])
    stems = np.linalg.norm(nodes[1:] - nodes[PARENTS[1:]], axis=1) @ THICK[1:]
    return stems + np.linalg.norm(PLACES - nodes[OWNERS], axis=1).sum()


found = minimize(wood, START.ravel(), method="Powell", options={"xtol": 1e-8, "ftol": 1e-12, "maxiter": 10**5, "maxfev": 10**6})
print(f"scipy {scipy.__version__}: from {wood(START.ravel()):.9f} to {found.fun:.9f} in {found.nfev} evaluations")
