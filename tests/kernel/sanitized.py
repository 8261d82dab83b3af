"""Pytest plugin (``-p kernel.sanitized``): takes the native room from the file that
``SKYKNOT_SANITIZED`` names, so that the tests run on a build with address and undefined-behaviour
sanitizers."""

from __future__ import annotations

import os
import sys
from importlib.machinery import ExtensionFileLoader
from importlib.util import module_from_spec, spec_from_loader
from pathlib import Path

path = Path(os.environ["SKYKNOT_SANITIZED"]).resolve()
name = f"skyknot.kernel.{path.name.split('.')[0]}"
loader = ExtensionFileLoader(name, str(path))
spec = spec_from_loader(name, loader)
assert spec is not None
module = module_from_spec(spec)
loader.exec_module(module)
sys.modules[name] = module
