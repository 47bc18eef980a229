from typing import Any

# What is public is in the stubs of the modules that export it.
def __getattr__(name: str) -> Any: ...
