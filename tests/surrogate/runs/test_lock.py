"""The lock on a folder, also where files cannot be locked; on Linux, standing in for those."""

import errno
import os
import subprocess
import sys

import pytest

from surrogate.errors import ResultsError
from surrogate.runs import lock
from surrogate.runs.journal import Journal
from surrogate.runs.lock import Lock

HOLD = """
import sys
from surrogate.runs import lock
lock.fcntl = None
held = lock.Lock(lock.Path(sys.argv[1]))
print("held", flush=True)
sys.stdin.read()
"""


def no_locks(*arguments):
    raise OSError(errno.ENOLCK, "No locks available")


@pytest.fixture(params=["no module", "no locks"])
def lockless(request, monkeypatch):
    """A system whose files cannot be locked."""
    if sys.platform == "win32":
        pytest.skip("Windows has locks")
    if request.param == "no module":
        monkeypatch.setattr(lock, "fcntl", None)
    else:
        monkeypatch.setattr(lock.fcntl, "lockf", no_locks)


def test_a_claim_keeps_others_out_and_goes_with_its_holder(tmp_path, lockless):
    path = tmp_path / "lock"
    program = [sys.executable, "-c", HOLD, str(path)]
    with subprocess.Popen(
        program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as holder:
        assert holder.stdout.readline() == "held\n"
        sentence = f"in use by process {holder.pid} on .*If it has ended, delete .*lock.claimed"
        with pytest.raises(ResultsError, match=sentence):
            Lock(path)
        holder.kill()
        holder.wait()
    held = Lock(path)  # the holder has ended, and cannot keep it
    with pytest.raises(ResultsError, match="in use by this process"):
        Lock(path)
    held.check()
    held.release()
    assert [one.name for one in tmp_path.iterdir()] == ["lock"]
    Lock(path).release()


def test_a_claim_of_another_machine_has_to_be_deleted_by_hand(tmp_path, lockless):
    claim = tmp_path / "lock.claimed"
    claim.write_text("process 1 on elsewhere, since 2026-01-01 00:00:00")
    with pytest.raises(ResultsError, match="in use by process 1 on elsewhere, since .* delete"):
        with Journal(tmp_path):
            pass
    claim.unlink()
    with Journal(tmp_path):
        assert f"process {os.getpid()} on " in claim.read_text()
    assert not claim.exists()


def test_other_troubles_of_the_disk_are_told(tmp_path, monkeypatch):
    def broken(*arguments):
        raise OSError(errno.EIO, "Input/output error")

    if sys.platform == "win32":
        pytest.skip("there is no fcntl")
    monkeypatch.setattr(lock.fcntl, "lockf", broken)
    with pytest.raises(ResultsError, match="Input/output error"):
        with Journal(tmp_path):
            pass
