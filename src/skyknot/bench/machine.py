"""What the times were measured on."""

from __future__ import annotations

import os
import platform
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from skyknot.kernel import isa_name
from skyknot.version import __version__


def machine_facts() -> dict[str, Any]:
    """Return processor, load, and versions, as plain data."""
    load = os.getloadavg() if hasattr(os, "getloadavg") else (float("nan"),) * 3
    return {
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "processor": processor_name(),
        "processors": os.cpu_count(),
        "instruction_set": isa_name(),
        "load_average": [round(value, 2) for value in load],
        "system": platform.platform(),
        "versions": {
            "skyknot": __version__,
            "casadi": str(ca.CasadiMeta.version()),
            "numpy": np.__version__,
            "python": platform.python_version(),
        },
    }


def processor_name() -> str:
    """Return the name of the processor as the system tells it."""
    listing = Path("/proc/cpuinfo")
    if listing.exists():
        for line in listing.read_text(encoding="utf-8").splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    return platform.processor() or platform.machine()
