"""Claim: a saved solution comes back bit for bit, and a damaged file says so."""

from __future__ import annotations

import dataclasses
import errno
import json
import pickle

import numpy as np
import pytest

import skyknot as sk
from agreement.variants import ALL_SCHEMES, CASES, PROBLEMS, SCHEMES
from skyknot import bank as problems
from skyknot import storage


@pytest.fixture(scope="module")
def solution():
    return sk.solve(PROBLEMS["everything"], SCHEMES["hermite-simpson"], "ipopt")


def assert_identical(a, b):
    """Compare two saved things bit for bit, field by field; ``problem`` is not saved."""
    assert type(a) is type(b)
    if isinstance(a, np.ndarray):
        assert a.dtype == b.dtype
        assert a.shape == b.shape
        assert a.tobytes() == b.tobytes()
    elif dataclasses.is_dataclass(a):
        for field in dataclasses.fields(a):
            if field.name != "problem":
                assert_identical(getattr(a, field.name), getattr(b, field.name))
    elif isinstance(a, dict):
        assert a.keys() == b.keys()
        for key in a:
            assert_identical(a[key], b[key])
    elif isinstance(a, float):
        assert np.float64(a).tobytes() == np.float64(b).tobytes()
    else:
        assert a == b


@pytest.mark.parametrize("scheme", ALL_SCHEMES)
def test_a_solution_comes_back_bit_for_bit(scheme, tmp_path):
    asked = "everything" if ("everything", scheme) in CASES else "path"
    solved = sk.solve(PROBLEMS[asked], ALL_SCHEMES[scheme])
    loaded = sk.load(solved.save(tmp_path / "solution.npz"))
    assert_identical(solved, loaded)
    t = np.linspace(0, solved.times[-1], 37)
    np.testing.assert_array_equal(loaded.state(t), solved.state(t))
    np.testing.assert_array_equal(loaded.control(t), solved.control(t))
    assert loaded.message == solved.message


def test_a_failed_solution_with_nan_in_it_comes_back_too(tmp_path):
    problem = sk.Problem(
        "nan", ["x"], ["u"], lambda x, u: [u[0] + (x[0] - 2) ** 0.5], 1.0, [0.0], [1.0]
    )
    solved = sk.solve(problem, sk.HermiteSimpson(4))
    assert solved.status == "evaluation error"
    assert_identical(solved, sk.load(solved.save(tmp_path / "failed")))


def test_gains_are_saved_where_there_are_any(solution, tmp_path):
    gains = np.random.default_rng(1).normal(size=(len(solution.times), 2, 2))
    richer = dataclasses.replace(solution, gains=gains)
    loaded = sk.load(richer.save(tmp_path / "gains.npz"))
    assert_identical(richer, loaded)
    np.testing.assert_array_equal(loaded.feedback(solution.times[2]), gains[2])
    halfway = 0.5 * (solution.times[2] + solution.times[3])
    np.testing.assert_allclose(loaded.feedback([halfway])[0], 0.5 * (gains[2] + gains[3]))


def test_without_gains_feedback_says_what_to_do(solution):
    with pytest.raises(sk.UserError, match="carries no feedback gains") as caught:
        solution.feedback(0.0)
    assert "ipopt" in caught.value.found


def test_the_suffix_is_added_and_folders_are_made(solution, tmp_path):
    path = solution.save(tmp_path / "deep" / "er" / "run.v2")
    assert path.name == "run.v2.npz"
    assert sk.load(path).objective == solution.objective


def test_a_loaded_solution_is_a_guess(solution, tmp_path):
    loaded = sk.load(solution.save(tmp_path / "s.npz"))
    again = sk.solve(PROBLEMS["everything"], SCHEMES["hermite-simpson"], "ipopt", guess=loaded)
    assert again.iterations <= 2


def test_a_loaded_solution_asks_for_its_problem_before_verifying(solution, tmp_path):
    loaded = sk.load(solution.save(tmp_path / "s.npz"))
    with pytest.raises(sk.UserError, match="does not carry its problem"):
        loaded.verify()


# --- damage ---------------------------------------------------------------------------------------


def refused(path):
    with pytest.raises(sk.UserError, match="not a readable skyknot solution") as caught:
        sk.load(path)
    assert str(path) in caught.value.where
    assert all(caught.value.parts().values())
    return caught.value


def test_a_missing_file_is_told(tmp_path):
    assert "no such file" in refused(tmp_path / "absent.npz").found


def test_a_folder_is_not_a_solution(tmp_path):
    refused(tmp_path)


@pytest.mark.parametrize("content", [b"", b"hello", b"PK\x03\x04 not really a zip", bytes(4096)])
def test_foreign_bytes_are_refused(content, tmp_path):
    path = tmp_path / "foreign.npz"
    path.write_bytes(content)
    refused(path)


def test_a_single_array_is_refused(tmp_path):
    path = tmp_path / "array.npy"
    np.save(path, np.ones(3))
    refused(path)


def test_an_archive_of_other_arrays_is_refused(tmp_path):
    path = tmp_path / "other.npz"
    np.savez(path, a=np.ones(3))
    assert "metadata" in refused(path).found


@pytest.mark.parametrize(
    "metadata", ['{"format": "skyknot solution 99"}', "[1, 2]", "not json", '"text"', "{}"]
)
def test_foreign_metadata_is_refused(metadata, tmp_path):
    path = tmp_path / "foreign.npz"
    np.savez(path, metadata=np.array(metadata))
    refused(path)


class Trap:
    """Runs when unpickled."""

    def __reduce__(self):
        return (print, ("executed",))


def test_a_pickle_is_refused_and_never_run(tmp_path, capsys):
    plain, hidden = tmp_path / "plain.npz", tmp_path / "hidden.npz"
    plain.write_bytes(pickle.dumps(Trap()))
    np.savez(hidden, metadata=np.array([Trap()], dtype=object))
    capsys.readouterr()
    refused(plain)
    refused(hidden)
    assert capsys.readouterr().out == ""


def test_a_truncated_file_is_refused_wherever_it_was_cut(solution, tmp_path):
    path = solution.save(tmp_path / "s.npz")
    content = path.read_bytes()
    for share in np.linspace(0.0, 0.999, 25):
        path.write_bytes(content[: int(share * len(content))])
        refused(path)


def test_flipped_bytes_are_refused_or_harmless(solution, tmp_path):
    path = solution.save(tmp_path / "s.npz")
    content, random = path.read_bytes(), np.random.default_rng(7)
    refusals = 0
    for _ in range(150):
        damaged = bytearray(content)
        damaged[random.integers(len(content))] ^= int(random.integers(1, 256))
        path.write_bytes(bytes(damaged))
        try:
            loaded = sk.load(path)
        except sk.UserError:
            refusals += 1
        else:
            assert_identical(solution, loaded)
    assert refusals > 100


@pytest.mark.parametrize("name", ["times", "costates", "segment_rates", "multiplier_defects"])
def test_a_missing_array_is_refused_by_its_name(solution, name, tmp_path):
    path = solution.save(tmp_path / "s.npz")
    with np.load(path) as stored:
        arrays = {key: stored[key] for key in stored.files if key != name}
    np.savez(path, **arrays)
    assert name.split("_")[-1] in str(refused(path))


def test_an_unknown_status_is_refused(solution, tmp_path):
    path = solution.save(tmp_path / "s.npz")
    with np.load(path) as stored:
        arrays = {key: stored[key] for key in stored.files}
    metadata = json.loads(str(arrays["metadata"])) | {"status": "glorious"}
    np.savez(path, **(arrays | {"metadata": np.array(json.dumps(metadata))}))
    assert "glorious" in refused(path).found


# --- writing --------------------------------------------------------------------------------------


def test_a_full_disk_leaves_the_old_file_and_no_litter(solution, tmp_path, monkeypatch):
    path = solution.save(tmp_path / "s.npz")
    before = path.read_bytes()

    def full(stream, **arrays):
        stream.write(b"half")
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(storage.np, "savez_compressed", full)
    with pytest.raises(sk.UserError, match="cannot be written") as caught:
        solution.save(path)
    assert "No space left" in caught.value.found
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["s.npz"]


def test_an_interrupt_while_writing_leaves_the_old_file_and_no_litter(
    solution, tmp_path, monkeypatch
):
    path = solution.save(tmp_path / "s.npz")
    before = path.read_bytes()

    def pressed(stream, **arrays):
        stream.write(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(storage.np, "savez_compressed", pressed)
    with pytest.raises(KeyboardInterrupt):
        solution.save(path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["s.npz"]


def test_a_place_below_a_file_cannot_be_written(solution, tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(sk.UserError, match="cannot be written") as caught:
        solution.save(tmp_path / "file" / "s.npz")
    assert "untouched" in caught.value.do


def test_a_folder_in_the_way_cannot_be_overwritten(solution, tmp_path):
    (tmp_path / "s.npz").mkdir()
    with pytest.raises(sk.UserError, match="cannot be written"):
        solution.save(tmp_path / "s.npz")
    with pytest.raises(sk.UserError, match="cannot be written"):
        sk.write_csv(solution, tmp_path / "s.npz")


# --- CSV ------------------------------------------------------------------------------------------


def test_the_csv_names_units_and_frame_and_reads_back_exactly(tmp_path):
    reference = problems.minimum_energy()
    solution = sk.solve(reference.problem, sk.HermiteSimpson(6))
    path = sk.write_csv(solution, tmp_path / "flight.csv")
    lines = path.read_text(encoding="utf-8").splitlines()
    header = "\n".join(line for line in lines if line.startswith("#"))
    assert "frame: NED" in header
    assert "t [s], x [m], v [m/s], a [m/s²]" in header
    assert "solved" in header
    table = np.genfromtxt(path, delimiter=",", names=True, skip_header=3, encoding="utf-8")
    assert table.dtype.names == ("t", "x", "v", "a")
    np.testing.assert_array_equal(table["t"], solution.times)
    np.testing.assert_array_equal(table["v"], solution.states[:, 1])
    np.testing.assert_array_equal(table["a"], solution.controls[:, 0])


def test_quantities_without_a_unit_get_a_dash(tmp_path):
    solution = sk.solve(problems.hager().problem, sk.HermiteSimpson(3))
    text = sk.write_csv(solution, tmp_path / "h.csv").read_text(encoding="utf-8")
    assert "x [-], u [-]" in text


def test_the_csv_of_one_long_segment_holds_its_points(tmp_path):
    reference = problems.minimum_energy()
    solution = sk.solve(reference.problem, sk.Radau(1, 9))
    path = sk.write_csv(solution, tmp_path / "long.csv")
    table = np.genfromtxt(path, delimiter=",", names=True, skip_header=3, encoding="utf-8")
    assert len(table["t"]) == 10
    assert np.all(np.diff(table["t"]) > 0)
    np.testing.assert_allclose(table["x"], reference.state(table["t"])[:, 0], atol=1e-12)
    np.testing.assert_allclose(table["a"], reference.control(table["t"])[:, 0], atol=1e-9)
