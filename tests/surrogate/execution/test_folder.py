"""Two programs that start at once: neither removes the folder that the other has just made."""

import shutil
import tempfile
import threading
from pathlib import Path

import pytest

from surrogate.errors import ResultsError
from surrogate.execution import folder
from surrogate.execution.folder import LOCK, owned_folder
from surrogate.runs import lock
from surrogate.runs.lock import Lock


@pytest.fixture
def abandoned(temporary):
    """The lock in the folder of a program that was killed."""
    path = temporary / "surrogate-old" / LOCK
    path.parent.mkdir()
    path.write_text("process 1")
    return path


def test_nobody_can_lock_a_folder_while_it_is_removed(abandoned, monkeypatch):
    """Whoever locked it would work in a folder that is gone a moment later."""
    removed, remove = [], shutil.rmtree

    def watched(path, **options):
        if path == abandoned.parent and not removed:
            with pytest.raises(ResultsError, match="is in use"):
                Lock(abandoned)
            removed.append(path)
        remove(path, **options)

    monkeypatch.setattr(folder.shutil, "rmtree", watched)
    with owned_folder() as ours:
        assert removed and not abandoned.parent.exists() and ours.exists()


@pytest.mark.parametrize("when", ["held", "removed"])
def test_a_start_that_loses_its_folder_to_another_makes_a_new_one(temporary, monkeypatch, when):
    """Before it is locked, another start may hold the new folder, or have removed it."""
    made, make = [], tempfile.mkdtemp

    def lost(**options):
        made.append(Path(make(**options)))
        if len(made) == 1:
            held.append(Lock(made[0] / LOCK)) if when == "held" else made[0].rmdir()
        return str(made[-1])

    held = []
    monkeypatch.setattr(folder.tempfile, "mkdtemp", lost)
    with owned_folder() as ours:
        assert ours == made[1] and (ours / LOCK).exists()
        with pytest.raises(ResultsError, match="in use by this process"):
            Lock(ours / LOCK)
    for one in held:
        one.release()


def test_a_lock_deleted_while_it_is_taken_is_not_ours(temporary, monkeypatch):
    """The folder goes between opening and locking: the start makes another."""
    locked, gone = lock._locked, []

    def late(file):
        if not gone:
            gone.extend(temporary.glob("surrogate-*"))
            shutil.rmtree(gone[0])
        return locked(file)

    monkeypatch.setattr(lock, "_locked", late)
    with owned_folder() as ours:
        assert ours not in gone and (ours / LOCK).exists()


def test_of_two_threads_one_gets_the_lock(tmp_path, monkeypatch):
    """The system gives a lock twice to one process: the second thread waits for the first."""
    taken, refused, others = lock._taken, [], []

    def second():
        try:
            refused.append(Lock(tmp_path / LOCK))
        except ResultsError as error:
            refused.append(error)

    def interrupted(path):
        if not others:
            others.append(threading.Thread(target=second))
            others[0].start()
            others[0].join(0.1)  # it would be through by now
        return taken(path)

    monkeypatch.setattr(lock, "_taken", interrupted)
    held = Lock(tmp_path / LOCK)
    others[0].join()
    (sentence,) = refused
    assert "in use by this process already" in str(sentence)
    held.release()
