import errno
import json
import os
import shutil
import signal
import subprocess
import sys
import textwrap
import time

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surrogate.errors import ResultsError
from surrogate.runs import journal, writing
from surrogate.runs.journal import Journal, read
from surrogate.runs.record import Record
from surrogate.solver import Output

WANTED = {"y": Output(), "field": Output(dims=("i",), coordinates={"i": np.arange(3.0)})}
FINITE = st.floats(allow_nan=False, allow_infinity=False)


def record(key, x=1.0, **more):
    return Record(key, {"x": x}, "ok", "", 0.1, 1, 1.7e9, outputs={"y": 2 * x}, **more)


def fill(folder, runs=5):
    with Journal(folder) as book:
        for i in range(runs):
            book.append(record(f"k{i}", i / 3), {"field": np.full((2, 3), i / 7)})


def check_filled(contents, keys):
    assert list(contents.records) == keys
    for key in keys:
        i = int(key[1:])
        assert contents.values(contents.records[key], "y") == 2 * (i / 3)
        assert (contents.values(contents.records[key], "field") == np.full((2, 3), i / 7)).all()


@settings(max_examples=25, deadline=None)
@given(x=FINITE, values=st.lists(FINITE, max_size=9), message=st.text())
def test_gives_back_every_bit(tmp_path_factory, x, values, message):
    """Doubles and texts survive the journal unchanged."""
    folder = tmp_path_factory.mktemp("journal")
    written = Record("k", {"x": x}, "ok", message, abs(x), 1, 0.0, outputs={"y": x})
    with Journal(folder) as book:
        book.append(written, {"field": np.array(values)})
    contents = read(folder)
    back = contents.records["k"]
    assert (back.inputs, back.message, back.seconds) == ({"x": x}, message, abs(x))
    assert contents.values(back, "field").tobytes() == np.array(values).tobytes()
    assert back.holds(WANTED) == (len(values) == 3)


def test_survives_a_cut_at_every_byte_of_the_last_record(tmp_path, monkeypatch):
    """Whatever part of the last line reached the disk, the others stay and work goes on."""
    monkeypatch.setattr(os, "fsync", lambda file: None)  # only for speed
    whole = tmp_path / "whole"
    fill(whole)
    data = (whole / journal.RECORDS).read_bytes()
    start = data[:-1].rfind(b"\n") + 1
    for cut in range(start, len(data)):
        torn = tmp_path / "torn"
        shutil.copytree(whole, torn)
        os.truncate(torn / journal.RECORDS, cut)
        check_filled(read(torn), ["k0", "k1", "k2", "k3"])
        with Journal(torn) as book:
            assert list(book.records) == ["k0", "k1", "k2", "k3"]
            book.append(record("k4", 4 / 3), {"field": np.full((2, 3), 4 / 7)})
        check_filled(read(torn), ["k0", "k1", "k2", "k3", "k4"])
        assert not read(torn).damaged
        shutil.rmtree(torn)


@pytest.mark.parametrize("lost", range(1, 49, 7))
def test_a_run_whose_array_is_torn_does_not_count(tmp_path, lost):
    """After a power cut the line may be there and the end of its array not."""
    fill(tmp_path)
    os.truncate(tmp_path / journal.FIELDS, 5 * 48 - lost)
    check_filled(read(tmp_path), ["k0", "k1", "k2", "k3"])
    assert read(tmp_path).damaged == {5: "its array 'field' is cut off"}
    with Journal(tmp_path) as book:
        book.append(record("k4", 4 / 3), {"field": np.full((2, 3), 4 / 7)})
    check_filled(read(tmp_path), ["k0", "k1", "k2", "k3", "k4"])


def test_a_changed_array_or_line_does_not_count(tmp_path):
    """Checksums find a flipped bit in an array; a line of zeros is no record."""
    fill(tmp_path)
    data = bytearray((tmp_path / journal.FIELDS).read_bytes())
    data[50] ^= 1
    (tmp_path / journal.FIELDS).write_bytes(data)
    lines = (tmp_path / journal.RECORDS).read_bytes().splitlines(keepends=True)
    lines[3] = b"\0" * (len(lines[3]) - 1) + b"\n"
    (tmp_path / journal.RECORDS).write_bytes(b"".join(lines))
    check_filled(read(tmp_path), ["k0", "k2", "k4"])
    assert read(tmp_path).damaged == {
        2: "the checksum of its array 'field' does not match",
        4: "it is no record of a run",
    }


def test_the_last_record_of_a_key_counts(tmp_path):
    with Journal(tmp_path) as book:
        book.append(record("k", 1.0))
        book.append(record("k", 2.0))
    assert read(tmp_path).records["k"].inputs == {"x": 2.0}


def test_a_missing_journal_is_empty(tmp_path):
    assert read(tmp_path / "none").records == {}
    assert not (tmp_path / "none").exists()


def test_a_journal_that_cannot_be_read_is_a_sentence(tmp_path):
    """A file where the folder should be, a folder where the file should be."""
    (tmp_path / "file").write_text("")
    (tmp_path / "folder" / journal.RECORDS).mkdir(parents=True)
    for place in (tmp_path / "file", tmp_path / "folder"):
        with pytest.raises(ResultsError, match="runs.jsonl cannot be read: .*directory"):
            read(place)


@pytest.mark.parametrize("room", [0, 1, 40, 47, 60, 200])
def test_a_full_disk_keeps_what_is_there(tmp_path, monkeypatch, room):
    """ENOSPC in the array or in the line: a sentence, and no torn record afterwards."""
    fill(tmp_path)
    write, left = os.write, [room]

    def full(file, data):
        if left[0] == 0:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        done = write(file, bytes(data[: left[0]]))
        left[0] -= done
        return done

    with Journal(tmp_path) as book:
        monkeypatch.setattr(os, "write", full)
        with pytest.raises(ResultsError, match="No space left.*finished so far are kept"):
            book.append(record("k5", 5 / 3), {"field": np.full((2, 3), 5 / 7)})
        monkeypatch.undo()
    assert not read(tmp_path).damaged
    check_filled(read(tmp_path), [f"k{i}" for i in range(5)])
    with Journal(tmp_path) as book:
        book.append(record("k5", 5 / 3), {"field": np.full((2, 3), 5 / 7)})
    check_filled(read(tmp_path), [f"k{i}" for i in range(6)])


def test_a_limit_of_file_size_keeps_what_is_there(tmp_path):
    """The system's own refusal (RLIMIT_FSIZE) in another process."""
    program = textwrap.dedent(f"""
        import resource
        from surrogate.runs.journal import Journal
        from surrogate.runs.record import Record
        resource.setrlimit(resource.RLIMIT_FSIZE, (5000, 5000))
        with Journal({str(tmp_path)!r}) as book:
            for i in range(1000):
                book.append(Record(f"k{{i}}", {{"x": i / 3}}, "ok", "", 0.1, 1, 0.0))
        """)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert "ResultsError: cannot write to" in done.stderr
    lines = (tmp_path / journal.RECORDS).read_bytes().splitlines(keepends=True)
    assert sum(map(len, lines)) + len(lines[-1]) > 5000
    assert list(read(tmp_path).records) == [f"k{i}" for i in range(len(lines))]
    assert not read(tmp_path).damaged


HOLD = """
import sys, time
from surrogate.runs.journal import Journal
with Journal(sys.argv[1]):
    print("held", flush=True)
    time.sleep(60)
"""


def test_two_processes_get_a_sentence_and_a_dead_one_loses_its_lock(tmp_path):
    with subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path)], stdout=subprocess.PIPE, text=True
    ) as holder:
        assert holder.stdout.readline() == "held\n"
        with pytest.raises(ResultsError, match=f"in use by process {holder.pid} on .* since"):
            with Journal(tmp_path):
                pass
        assert read(tmp_path).records == {}
        holder.send_signal(signal.SIGKILL)
        holder.wait()
        with Journal(tmp_path) as book:
            book.append(record("k"))
    assert list(read(tmp_path).records) == ["k"]


def test_one_process_cannot_open_it_twice(tmp_path):
    with Journal(tmp_path):
        with pytest.raises(ResultsError, match="in use by this process already"):
            with Journal(tmp_path / ".." / tmp_path.name):
                pass
    with Journal(tmp_path) as book:
        book.append(record("k"))


def test_reaches_the_disk_within_a_second_but_not_at_each_run(tmp_path, monkeypatch):
    """Group fsync: arrays first, then lines; at most 0.5 s after a run, once per 0.5 s."""
    now, synced, fsync = [100.0], [], os.fsync
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    monkeypatch.setattr(os, "fsync", lambda file: (synced.append(file), fsync(file)))
    with Journal(tmp_path) as book:
        for i in range(100):
            book.append(record(f"k{i}"), {"field": np.zeros(3)})
            now[0] += 0.03
        assert len(synced) == 2 * 5
        assert synced[0] == book._writer._fields.file and synced[1] == book._writer._records.file
        now[0] += writing.SYNC_SECONDS
        book.sync()
        assert len(synced) == 2 * 6
        book.sync()
        assert len(synced) == 2 * 6


def test_reading_a_record_costs_little_more_than_its_json(tmp_path):
    """In processor time, ten thousand of them in the same process."""
    line = json.dumps({**vars(record("k")), "inputs": {f"p{i}": i / 7 for i in range(9)}})
    text = "".join(line.replace('"k"', f'"k{i}"', 1) + "\n" for i in range(10_000))
    (tmp_path / journal.RECORDS).write_text(text)
    start = time.process_time()
    decoded = [json.loads(one) for one in text.splitlines()]
    middle = time.process_time()
    assert len(read(tmp_path).records) == len(decoded)
    assert time.process_time() - middle < 10.0 * (middle - start)


def test_a_folder_that_cannot_be_made_is_a_sentence(tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(ResultsError, match="cannot write to .*file"):
        with Journal(tmp_path / "file"):
            pass
