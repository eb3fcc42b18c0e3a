"""What tests of the command `leg-bandage` share."""

import sys

import pytest

from surrogate_solvers.leg_bandage import cli


@pytest.fixture
def command(monkeypatch, capsys):
    """Runs the command; returns exit status, standard output, standard error."""

    def run(*words):
        monkeypatch.setattr(sys, "argv", ["leg-bandage", *map(str, words)])
        with pytest.raises(SystemExit) as stop:
            cli.main()
        return stop.value.code or 0, *capsys.readouterr()

    return run
