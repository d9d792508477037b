"""The cache of plans: what is kept, what is found again, and what counts as not there."""

from __future__ import annotations

import os
import stat
import threading
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from geotween.export.cache import VARIABLE, Cache, default_cache

KEY, OTHER, THIRD = "aa" * 32, "bb" * 32, "cc" * 32
SMALL = {"one": np.arange(6.0).reshape(2, 3), "two": np.arange(3)}
LARGE = {"one": np.zeros(10_000)}


@pytest.fixture
def cache(tmp_path: Path) -> Cache:
    return Cache(tmp_path / "deep" / "cache")


def entries(cache: Cache) -> list[Path]:
    return sorted(cache.folder.glob("*/*"))


def test_what_is_put_is_got(cache: Cache) -> None:
    cache.put(KEY, SMALL)
    found = cache.get(KEY)
    assert found is not None
    assert set(found) == set(SMALL)
    for name, array in SMALL.items():
        assert_array_equal(found[name], array)
        assert found[name].dtype == array.dtype


def test_nothing_else_is_got(cache: Cache) -> None:
    assert cache.get(KEY) is None
    cache.put(KEY, SMALL)
    assert cache.get(OTHER) is None


def test_an_entry_is_its_owners_alone(cache: Cache) -> None:
    cache.put(KEY, SMALL)
    modes = [stat.S_IMODE(p.stat().st_mode) for p in (cache.folder, *entries(cache))]
    assert [mode & 0o077 for mode in modes] == [0, 0]


@pytest.mark.parametrize("spoilt", [b"", b"PK\x03\x04", b"not an archive", None])
def test_a_spoilt_entry_is_not_there_and_is_written_anew(
    cache: Cache, spoilt: bytes | None
) -> None:
    cache.put(KEY, SMALL)
    (path,) = entries(cache)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2] if spoilt is None else spoilt)
    assert cache.get(KEY) is None
    cache.put(KEY, SMALL)
    assert cache.get(KEY) is not None


def test_one_flipped_bit_is_seen(cache: Cache) -> None:
    cache.put(KEY, LARGE)
    (path,) = entries(cache)
    spoilt = bytearray(path.read_bytes())
    spoilt[len(spoilt) // 2] ^= 1
    path.write_bytes(spoilt)
    assert cache.get(KEY) is None


class Trap:
    """Runs code where it is unpickled."""

    def __init__(self, place: Path) -> None:
        self.place = place

    def __reduce__(self) -> tuple[object, ...]:
        return os.mkdir, (str(self.place),)


def test_a_foreign_entry_runs_no_code(cache: Cache, tmp_path: Path) -> None:
    cache.put(KEY, SMALL)
    (path,) = entries(cache)
    trap = np.array([Trap(tmp_path / "sprung")], dtype=object)
    with path.open("wb") as file:
        np.savez(file, one=trap, allow_pickle=True)
    assert cache.get(KEY) is None
    assert not (tmp_path / "sprung").exists()


def test_what_was_used_last_stays(cache: Cache) -> None:
    for age, key in enumerate((KEY, OTHER, THIRD)):
        cache.put(key, LARGE)
        path = cache.folder / key[:2] / f"{key}.npz"
        os.utime(path, (1000 + age, 1000 + age))
    assert cache.get(KEY) is not None  # the oldest, and now the newest
    replace(cache, largest=200_000).prune()
    assert [cache.get(key) is not None for key in (KEY, OTHER, THIRD)] == [True, False, True]


def test_a_small_cache_is_left_alone(cache: Cache) -> None:
    cache.put(KEY, SMALL)
    cache.prune()
    assert cache.get(KEY) is not None


def test_a_folder_that_cannot_be_made_is_no_fault(tmp_path: Path) -> None:
    (tmp_path / "taken").write_text("mine")
    cache = Cache(tmp_path / "taken")
    cache.put(KEY, SMALL)
    cache.prune()
    assert cache.get(KEY) is None
    assert (tmp_path / "taken").read_text() == "mine"


def test_readers_see_whole_entries_while_others_write(cache: Cache) -> None:
    """Each entry has the same number everywhere: one that is torn would have two."""
    done = threading.Event()

    def write(value: int) -> None:
        while not done.is_set():
            cache.put(KEY, {"one": np.full(50_000, value)})

    writers = [threading.Thread(target=write, args=(value,)) for value in (1, 2)]
    cache.put(KEY, {"one": np.full(50_000, 0)})
    for writer in writers:
        writer.start()
    try:
        for _ in range(50):
            found = cache.get(KEY)
            assert found is not None
            assert len(np.unique(found["one"])) == 1
    finally:
        done.set()
        for writer in writers:
            writer.join()
    assert [path.name for path in entries(cache)] == [f"{KEY}.npz"]


def test_the_folder_is_the_one_that_is_named(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv(VARIABLE, str(tmp_path / "named"))
    assert default_cache() == Cache(tmp_path / "named")
    monkeypatch.setenv(VARIABLE, "")
    assert default_cache() is None
    monkeypatch.delenv(VARIABLE)
    found = default_cache()
    assert found is not None
    assert found.folder.name in ("geotween", "Cache")
