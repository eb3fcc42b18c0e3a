"""What other systems lack (Windows, macOS) is asked for before it is used.

Linux stands in for them: a `sitecustomize` takes away, in every Python process, what they do
not have. What they do differently is seen by the workflow in .github/ only.
"""

import json
import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

import surrogate
import surrogate_solvers

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="Linux stands in for others")

#: What Windows' Python, or macOS', does not have, but for what Linux' own library needs.
LACKING = {
    "os": [
        "fork", "killpg", "setsid", "getpgid", "mkfifo", "O_NONBLOCK", "posix_fallocate",
        "sched_getaffinity", "pidfd_open",
    ],
    "signal": [
        "pthread_sigmask", "SIGHUP", "SIGQUIT", "SIGPWR", "SIGXCPU", "SIGALRM", "setitimer",
        "SIGUSR1",
    ],
}  # fmt: skip
MISSING_MODULES = ["fcntl", "resource", "pwd", "grp", "termios"]

WITHOUT = f"""
import asyncio, os, signal, sys  # asyncio takes what this system has
for name in {MISSING_MODULES}:
    sys.modules[name] = None
for module, names in {LACKING!r}.items():
    for name in names:
        if hasattr(sys.modules[module], name):
            delattr(sys.modules[module], name)
there = os.path.exists, os.path.isdir, os.listdir
os.path.exists = lambda path: not str(path).startswith("/proc") and there[0](path)
os.path.isdir = lambda path: not str(path).startswith("/proc") and there[1](path)
"""


@pytest.fixture
def elsewhere(tmp_path):
    """Runs a Python program on a system without all that."""
    (tmp_path / "sitecustomize.py").write_text(WITHOUT)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "PYTHONWARNINGS": "ignore"}

    def run(program, *words):
        done = subprocess.run(
            [sys.executable, "-c", textwrap.dedent(program), *words],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            timeout=120,
        )
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


def modules(package):
    root = Path(package.__path__[0])
    for path in sorted(root.rglob("*.py")):
        parts = path.relative_to(root).with_suffix("").parts
        name = ".".join((package.__name__, *parts)).removesuffix(".__init__")
        if path.stem not in ("__main__", "supervisor"):  # programs of their own
            yield name


def test_every_module_can_be_imported(elsewhere):
    names = [*modules(surrogate), *modules(surrogate_solvers)]
    assert len(names) > 150
    program = """
        import importlib, json, sys
        failed = {}
        for name in json.loads(sys.argv[1]):
            try:
                importlib.import_module(name)
            except ImportError as error:
                if error.name not in ("matplotlib", "openpyxl", "pyarrow"):
                    failed[name] = repr(error)
            except Exception as error:
                failed[name] = repr(error)
        print(json.dumps(failed))
        """
    assert json.loads(elsewhere(program, json.dumps(names))) == {}


STUDY = """
study: small
solver:
  name: command
  options:
    command: ["{python}", -c, "print('y =', {{{{ a }}}} * {{{{ b }}}})"]
    timeout: 60 s
    inputs: {{a: {{range: [0, 1]}}, b: {{range: [0, 1]}}}}
    outputs: {{y: {{regex: 'y = (.*)'}}}}
parameters: {{a: [0, 1], b: [0, 1]}}
designs: {{train: {{method: sobol, runs: 8, seed: 1}}, test: {{method: halton, runs: 3}}}}
surrogates: {{quadratic: {{method: quadratic}}}}
execution: {{workers: 2, timeout: 2 min}}
"""


def test_a_study_of_an_external_program_goes_to_its_report(elsewhere, tmp_path):
    """Workers, journal, lock and programs, without sessions, groups and locks of POSIX."""
    (tmp_path / "small.yaml").write_text(STUDY.format(python=sys.executable))
    elsewhere("""
        import sys
        from surrogate.__main__ import main
        if __name__ == "__main__":
            sys.argv = ["surrogate", "run", "small.yaml"]
            main()
        """)
    summary = json.loads((tmp_path / "results/small/summary.json").read_text())
    assert summary["comparison"]["q2_test"]["values"] == [[pytest.approx(1.0)]]
    assert (tmp_path / "results/small/report.html").exists()
