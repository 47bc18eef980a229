"""Totals of slabs by S. Prahl's adding-doubling, which judge those of layers.

pip install iadpython==0.5.3 numpy scipy, then python adding_doubling.py: the rows of ADDING_DOUBLING in
crates/translucid-reference/src/layers/totals/tests.rs. Without a face that reflects 16 points are its best, elsewhere 32.
"""

import iadpython

for a, b, g, n, slide in [
    (0.9, 1.0, 0.0, 1.0, 1.0),
    (0.9, 1.0, 0.8, 1.0, 1.0),
    (0.5, 2.0, 0.0, 1.0, 1.0),
    (0.99, 5.0, 0.5, 1.0, 1.0),
    (0.9, 1.0, 0.0, 1.4, 1.0),
    (0.95, 2.0, 0.0, 1.5, 1.0),
    (0.9, 4.0, 0.6, 1.4, 1.0),
    (0.9, 2.0, 0.0, 1.33, 1.5),
]:
    points = 16 if n == 1.0 else 32
    slab = iadpython.Sample(a=a, b=b, g=g, n=n, n_above=slide, n_below=slide, quad_pts=points)
    totals = ", ".join(f"{value:.9f}" for value in slab.rt())
    print(f"([{a}, {b}, {g}, {n}, {slide}], [{totals}]),")
