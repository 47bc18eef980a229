"""Notes by which other programs find the names of Cryptomattes."""

import json

import numpy as np

from . import _translucid


def cryptomatte_metadata(layer, names):
    """Make the notes that a file with the Cryptomatte of some names needs for them to be picked.

    Parameters
    ----------
    layer : str
        Name of the layer without the number of its part, as in ``'View.CryptoObject'`` for channels
        ``View.CryptoObject00.r`` …, which have the first two pairs of `Session.cryptomatte` in r, g and b, a.
    names : iterable of str
        The names in it.

    Returns
    -------
    dict of str to str
        Attributes of the file by their names.

    Examples
    --------
    >>> notes = translucid.cryptomatte_metadata("View.CryptoObject", ["ball"])
    >>> for key, text in notes.items():
    ...     print(key, text)
    cryptomatte/484a946/name View.CryptoObject
    cryptomatte/484a946/hash MurmurHash3_32
    cryptomatte/484a946/conversion uint32_to_float32
    cryptomatte/484a946/manifest {"ball":"645d3bc4"}
    """
    ids = {name: f"{np.float32(_translucid.cryptomatte_id(name)).view(np.uint32):08x}" for name in names}
    notes = {
        "name": layer,
        "hash": "MurmurHash3_32",
        "conversion": "uint32_to_float32",
        "manifest": json.dumps(ids, ensure_ascii=False, separators=(",", ":")),
    }
    key = f"{_translucid._cryptomatte_hash(layer):08x}"[:7]
    return {f"cryptomatte/{key}/{name}": text for name, text in notes.items()}
