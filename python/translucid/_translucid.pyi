# What is public of it is in the stubs of `translucid` and `translucid.reference`.
from typing import Any

def __getattr__(name: str) -> Any: ...
