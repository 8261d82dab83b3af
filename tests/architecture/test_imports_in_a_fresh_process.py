"""Claim: importing the package changes nothing, and loads nothing heavy that it does not need."""

from __future__ import annotations

import json
import subprocess
import sys
import textwrap

WITNESS = """
    import json, logging, os, signal, sys, threading, warnings
    import casadi, numpy, pydantic, scipy.optimize

    def options():
        names = [name for name in dir(casadi.GlobalOptions) if name.startswith("get")]
        return {name: repr(getattr(casadi.GlobalOptions, name)()) for name in names}

    def witness():
        return {
            "environment": dict(os.environ),
            "folder": os.getcwd(),
            "warning filters": [repr(entry) for entry in warnings.filters],
            "floating-point errors": numpy.geterr(),
            "print options": repr(numpy.get_printoptions()),
            "casadi options": options(),
            "signals": [repr(signal.getsignal(s)) for s in (signal.SIGINT, signal.SIGTERM)],
            "log handlers": len(logging.getLogger().handlers),
            "threads": threading.active_count(),
            "exception hook": repr(sys.excepthook),
            "random state": repr(numpy.random.get_state()[1][:5].tolist()),
        }

    before = witness()
    import skyknot
    after = witness()
    print(json.dumps([before, after]))
"""


def fresh(script):
    finished = subprocess.run(
        [sys.executable, "-W", "error", "-c", textwrap.dedent(script)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert finished.returncode == 0, finished.stderr
    return finished


def test_importing_changes_nothing_in_the_process():
    before, after = json.loads(fresh(WITNESS).stdout)
    assert len(before["casadi options"]) > 3
    assert after == before


def test_importing_prints_nothing():
    finished = fresh("import skyknot")
    assert finished.stdout == finished.stderr == ""


def test_importing_loads_no_plotting_and_no_integrators():
    loaded = json.loads(
        fresh("import json, sys, skyknot; print(json.dumps(sorted(sys.modules)))").stdout
    )
    for heavy in ("matplotlib", "plotly", "scipy.integrate", "pandas", "IPython", "rich", "typer"):
        assert heavy not in loaded, heavy


def test_solving_needs_no_plotting_either():
    script = """
        import sys, skyknot as sk
        problem = sk.Problem("p", ["x"], ["u"], lambda x, u: [u[0]], 1.0, [0.0], [1.0],
                             running_cost=lambda x, u: u[0] ** 2)
        assert sk.solve(problem, sk.HermiteSimpson(3)).success
        assert not {"matplotlib", "plotly"} & set(sys.modules)
    """
    fresh(script)


def test_every_room_imports_alone():
    """Any room can be the first one imported: no order of imports is needed."""
    script = """
        import importlib, pkgutil, sys, skyknot
        names = [m.name for m in pkgutil.iter_modules(skyknot.__path__, "skyknot.")]
        for name in names:
            for loaded in [key for key in sys.modules if key.split(".")[0] == "skyknot"
                           and "_native" not in key and "_cpu" not in key]:
                del sys.modules[loaded]
            importlib.import_module(name)
        print(len(names))
    """
    assert int(fresh(script).stdout) > 10
