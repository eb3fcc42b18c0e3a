"""Journals that disks, people and other programs have changed."""

import json
import os
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest

from surrogate.cli.verbs import app
from surrogate.errors import ResultsError
from surrogate.execution.execute import execute
from surrogate.runs import journal
from surrogate.runs.identity import SolverSpec
from surrogate.runs.journal import Journal, read
from surrogate.runs.record import Record, from_line, to_line
from surrogate.solver import Input, Output

WHOLE = Record(
    "8f14e45fceea167a5a36dedd4bea2543",
    {"x": 0.7757, "way": "well"},
    "ok",
    "",
    0.25,
    1,
    1.7e9,
    None,
    {"y": 0.7757, "gap": float("nan")},
    {"field": {"offset": 0, "shape": [2, 3], "crc": 1}},
    {"solver": "beam", "version": "1", "options": {}},
)
OLD = json.dumps({**vars(WHOLE), "outputs": {"y": 0.7757, "gap": None}}).encode()


def test_every_flipped_bit_of_a_record_is_found():
    """No flip gives another answer."""
    line = to_line(WHOLE)[:-1]
    assert from_line(line) == from_line(OLD)
    for byte in range(len(line)):
        for bit in range(8):
            flipped = bytearray(line)
            flipped[byte] ^= 1 << bit
            with pytest.raises(ValueError):
                from_line(bytes(flipped))


def lines_of(folder):
    return (folder / journal.RECORDS).read_bytes().split(b"\n")


def spoil(folder, number, line):
    """Put `line` in place of line `number` (from 1) of a journal."""
    lines = lines_of(folder)
    lines[number - 1] = line
    (folder / journal.RECORDS).write_bytes(b"\n".join(lines))


class Doubling:
    """A solver that counts its calls in a file."""

    version, inputs, outputs = "1", {"x": Input()}, {"y": Output()}

    def __init__(self, diary):
        self.diary = diary

    def __call__(self, x):
        with open(self.diary, "a") as file:
            file.write(f"{x}\n")
        return {"y": 2 * x}


@pytest.fixture
def runs(tmp_path):
    """Do ten runs in a study's folder; gives the same call and the calls that were made."""
    diary = tmp_path / "diary"
    spec = SolverSpec("doubling", Doubling, {"diary": str(diary)})

    def run(folder, **options):
        before = len(diary.read_text().split()) if diary.exists() else 0
        with ThreadPoolExecutor(1) as executor:
            execute(
                spec,
                {"x": np.arange(10.0)},
                journal=folder,
                executor=executor,
                workers=1,
                **options,
            )
        return [float(x) for x in diary.read_text().split()][before:]

    return run


def test_a_damaged_record_is_told_with_its_line_and_done_again(tmp_path, runs):
    """Once it is done again nothing is told any more; the damaged line is kept aside."""
    home = tmp_path / "journal"
    assert runs(home) == list(range(10))
    spoiled = lines_of(home)[3].replace(b'"y": 6.0', b'"y": 7.0')
    spoil(home, 4, spoiled)
    (told,) = read(home).told
    assert told.startswith(f"{home / journal.RECORDS}, line 4: the record is damaged (its checksum")
    assert runs(home) == [3.0]
    assert read(home).told == [] and len(read(home).records) == 10
    assert {r.inputs["x"]: r.outputs["y"] for r in read(home).records.values()}[3.0] == 6.0
    assert (home / journal.DAMAGED).read_bytes() == spoiled + b"\n"


def test_the_command_tells_damage_and_mends_it(tmp_path, capsys):
    """`status` and `run` name the line; after `run` nothing is left to tell."""
    (tmp_path / "s.yaml").write_text(
        "study: s\nsolver: {name: ishigami}\n"
        "parameters: {X1: [0, 1], X2: [0, 1], X3: [0, 1]}\n"
        "designs: {train: {method: sobol, runs: 8, seed: 1}}\n"
        "surrogates: {linear: {method: linear}}\n"
    )
    words = [str(tmp_path / "s.yaml"), "--results", str(tmp_path / "results")]

    def said(verb):
        with suppress(SystemExit):
            app([verb, *words])
        return "".join(capsys.readouterr())

    said("run")
    home = tmp_path / "results" / "s" / "journal"
    spoil(home, 3, lines_of(home)[2].replace(b'"status": "ok"', b'"status": "no"'))
    for verb in ("check", "status", "run"):
        assert "runs.jsonl, line 3: the record is damaged" in said(verb)
    assert "damaged" not in said("status")
    assert len(read(home).records) == 8


def changed(**parts):
    return json.dumps({**json.loads(OLD), **parts}).encode()


OF_ANOTHER_SHAPE = {
    "field without a place": changed(fields={"y": {}}),
    "field of text": changed(fields={"y": "here"}),
    "fields as a list": changed(fields=["y"]),
    "negative shape": changed(fields={"y": {"offset": 0, "shape": [-1], "crc": 0}}),
    "huge shape": changed(fields={"y": {"offset": 0, "shape": [2**39, 2**39], "crc": 0}}),
    "shape of lists": changed(fields={"y": {"offset": 0, "shape": [[1]], "crc": 0}}),
    "offset of text": changed(fields={"y": {"offset": "0", "shape": [1], "crc": 0}}),
    "negative offset": changed(fields={"y": {"offset": -8, "shape": [1], "crc": 0}}),
    "output of text": changed(outputs={"y": "4.5"}),
    "output true": changed(outputs={"y": True}),
    "output of a list": changed(outputs={"y": [1.0]}),
    "output beyond doubles": OLD.replace(b'"y": 0.7757', b'"y": 1' + 400 * b"0"),
    "output infinite": OLD.replace(b'"y": 0.7757', b'"y": 1e999'),
    "output of 5000 digits": OLD.replace(b'"y": 0.7757', b'"y": ' + 5000 * b"9"),
    "outputs of text": changed(outputs="y"),
    "input of a list": changed(inputs={"x": []}),
    "inputs as a list": changed(inputs=[]),
    "status unknown": changed(status="done"),
    "status of a list": changed(status=["ok"]),
    "message of a number": changed(message=1),
    "seconds of text": changed(seconds="1"),
    "attempts of 1e300": changed(attempts=1e300),
    "finished in the year 10^292": changed(finished=1e300),
    "finished never": changed(finished=None),
    "limit of text": changed(limit="1 min"),
    "solver of text": changed(solver="beam"),
    "key of a list": changed(key=["k"]),
    "another word": changed(more=1),
    "no words": b"{}",
    "a list": b"[1, 2]",
    "a number": b"3",
    "null": b"null",
    "200 000 brackets": 200_000 * b"[",
    "200 000 mappings": 200_000 * b'{"key":',
    "no UTF-8": b"\xff\xfe",
    "zeros": 300 * b"\0",
    "checksum alone": b'{"crc": "',
    "checksum of nothing": b'{"crc": "00000000", ',
}


@pytest.mark.parametrize("line", OF_ANOTHER_SHAPE.values(), ids=OF_ANOTHER_SHAPE)
def test_a_line_of_another_shape_is_dropped_and_told(tmp_path, line):
    with Journal(tmp_path) as book:
        for key in "abc":
            book.append(Record(key, {"x": 1.0}, "ok", "", 0.1, 1, 1.7e9, outputs={"y": 2.0}))
    spoil(tmp_path, 2, line)
    assert list(read(tmp_path).records) == ["a", "c"]
    assert list(read(tmp_path).damaged) == [2]
    with Journal(tmp_path) as book:
        assert list(book.records) == ["a", "c"]
    assert not read(tmp_path).damaged


@pytest.mark.parametrize("name", ["field without a place", "200 000 brackets", "no UTF-8"])
def test_neighbours_with_damaged_journals_do_not_stop_a_study(tmp_path, runs, name):
    """What is whole in them is taken over; one that cannot be read at all is passed by."""
    runs(tmp_path / "old")
    spoil(tmp_path / "old", 5, OF_ANOTHER_SHAPE[name])
    (tmp_path / "odd" / journal.RECORDS).mkdir(parents=True)
    others = [tmp_path / "odd", tmp_path / "old"]
    assert runs(tmp_path / "new", others=others) == [4.0]
    assert list(read(tmp_path / "old").damaged) == [5]


def test_an_array_of_another_shape_than_declared_does_not_count(tmp_path):
    """A solver that changed an output's shape and not its version."""
    with Journal(tmp_path) as book:
        book.append(Record("k", {}, "ok", "", 0.1, 1, 1.7e9), {"field": np.zeros(2)})
    record = read(tmp_path).records["k"]
    two, three = (Output(dims=("i",), coordinates={"i": np.arange(float(n))}) for n in (2, 3))
    assert record.answers({"field": two})
    assert not record.answers({"field": three}) and not record.answers({"field": Output()})


def test_journals_of_the_first_version_are_read_and_go_on(tmp_path):
    """Lines without a checksum; new ones have one."""
    old = changed(fields={})
    (tmp_path / journal.RECORDS).write_bytes(old + b"\n" + old.replace(b"8f14", b"0000") + b"\n")
    with Journal(tmp_path) as book:
        assert len(book.records) == 2
        book.append(Record("k", {"x": 1.0}, "ok", "", 0.1, 1, 1.7e9))
    assert len(read(tmp_path).records) == 3 and not read(tmp_path).damaged
    assert [line[:5] for line in lines_of(tmp_path)[:3]] == [b'{"key', b'{"key', b'{"crc']


def test_line_ends_of_windows_are_no_damage(tmp_path):
    line = to_line(WHOLE).replace(b"\n", b"\r\n")
    assert from_line(line[:-1]) == from_line(OLD)


# Files that are deleted while runs go on


def record(key):
    return Record(key, {"x": 1.0}, "ok", "", 0.1, 1, 1.7e9, outputs={"y": 2.0})


def try_to_write(folder):
    """What another process is told that writes one record there."""
    program = (
        "import sys\n"
        "from surrogate.errors import ResultsError\n"
        "from surrogate.runs.journal import Journal\n"
        "from surrogate.runs.record import Record\n"
        "try:\n"
        "    with Journal(sys.argv[1]) as book:\n"
        "        book.append(Record('theirs', {}, 'ok', '', 0.1, 1, 1.7e9))\n"
        "        print('written', flush=True)\n"
        "        sys.stdin.readline()\n"
        "except ResultsError as error:\n"
        "    print(error)\n"
    )
    return subprocess.Popen(
        [sys.executable, "-c", program, str(folder)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )


def test_a_deleted_lock_is_taken_again(tmp_path):
    """At the next sign of life, at most a fifth of a second later; the second run is refused."""
    with Journal(tmp_path) as book:
        book.append(record("a"))
        os.unlink(tmp_path / journal.LOCK)
        book.sync()
        said, _ = try_to_write(tmp_path).communicate("\n")
        assert f"is in use by process {os.getpid()} on" in said
        book.append(record("b"))
    assert list(read(tmp_path).records) == ["a", "b"]


def test_who_lost_the_lock_stops_and_no_record_is_lost(tmp_path):
    """A second run that started between deletion and the next sign of life keeps the lock."""
    with pytest.raises(ResultsError, match="in use by process"):
        with Journal(tmp_path) as book:
            book.append(record("a"))
            os.unlink(tmp_path / journal.LOCK)
            second = try_to_write(tmp_path)
            assert second.stdout.readline() == "written\n"
            book.append(record("b"))
    second.communicate("\n")
    assert list(read(tmp_path).records) == ["a", "theirs", "b"]
    assert not read(tmp_path).damaged


@pytest.mark.parametrize("name", [journal.RECORDS, journal.FIELDS])
def test_a_deleted_or_replaced_journal_stops_its_writer(tmp_path, name):
    for replace in (False, True):
        with pytest.raises(ResultsError, match=f"{name} was deleted or replaced while runs"):
            with Journal(tmp_path) as book:
                book.append(record("a"))
                os.rename(tmp_path / name, tmp_path / "away")
                if replace:
                    shutil.copy(tmp_path / "away", tmp_path / name)
                book.append(record("b"))


def test_a_deleted_results_folder_is_a_sentence(tmp_path):
    home = tmp_path / "journal"
    with pytest.raises(ResultsError, match="was deleted or replaced"):
        with Journal(home) as book:
            book.append(record("a"))
            shutil.rmtree(home)
            book.sync()
    assert not Path(home).exists()
