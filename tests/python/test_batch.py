"""gscl.batch: reports, resuming, workers that are killed, devices, the program."""

import collections
import io
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import tempfile
import threading
import time
import types

import distributed
import fsspec
import numpy
import pyarrow.parquet
import pytest
from fsspec.implementations.dirfs import DirFileSystem
from PIL import Image

import gscl
import gscl.batch
from conftest import make_picture
from gscl.batch import _conversions, _machine, _plan, _storage
from gscl.batch.__main__ import _KINDS as batch_kinds
from gscl.batch.__main__ import main as batch_main

FAST = {"effort": 0, "bytes": 200}


def write_pictures(folder, count):
    """Pictures of 32 x 32 pixels, all different, in two folders."""
    for i in range(count):
        path = folder / ("a" if i % 2 else "b") / f"{i:03d}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(numpy.roll(make_picture(32, 32), i, axis=1) - numpy.uint8(i // 32)).save(path)
    return folder


def rows_of(report):
    """All rows as they are in the files, without the care of read_report."""
    parts = sorted(pathlib.Path(report).glob("*.parquet"))
    return [row for part in parts for row in pyarrow.parquet.read_table(part).to_pylist()]


def statuses(report):
    return collections.Counter(gscl.batch.read_report(str(report))["status"].to_pylist())


def check_outputs(rows):
    """Each output is a whole file of the size that its row has; nothing unfinished is left."""
    for row in rows:
        if row["status"] != "failed":
            data = pathlib.Path(row["output"]).read_bytes()
            info = gscl.info(data)
            assert (len(data), info.width, info.height, info.splats) == (
                row["bytes"],
                row["width"],
                row["height"],
                row["splats"],
            )


def check_nothing_else(out, rows):
    files = {str(path) for path in out.rglob("*") if path.is_file()}
    assert files == {row["output"] for row in rows if row["status"] != "failed"}


# ---- Workers in processes ------------------------------------------------------------------------


@pytest.fixture(scope="module")
def client():
    """A scheduler and four worker processes."""
    with distributed.LocalCluster(
        n_workers=4, threads_per_worker=1, dashboard_address="127.0.0.1:0", silence_logs=50
    ) as cluster:
        with distributed.Client(cluster) as client:
            yield client


def test_killed_worker(client, tmp_path):
    """One of four workers is killed in the middle: each picture is in the report once, and none is lost."""
    count = 200
    pictures, out, report = write_pictures(tmp_path / "pictures", count), tmp_path / "out", tmp_path / "report"
    (pictures / "a/bad.png").write_text("no picture")
    processes = client.run(os.getpid)
    victim, *others = processes.values()
    remaining = []

    def kill():
        while sum(1 for _ in out.rglob("*.gscl")) < count // 5:
            time.sleep(0.005)
        os.kill(victim, signal.SIGKILL)
        remaining.append(count - sum(1 for _ in out.rglob("*.gscl")))
        # The others stand still until another worker has taken the victim's place, so that work is left for it.
        for process in others:
            os.kill(process, signal.SIGSTOP)
        while not set(client.scheduler_info(n_workers=-1)["workers"]) - set(processes):
            time.sleep(0.005)
        for process in others:
            os.kill(process, signal.SIGCONT)

    killer = threading.Thread(target=kill)
    killer.start()
    states = []
    summary = gscl.batch.run(
        f"{pictures}/**/*.png", str(out), str(report), client=client, progress=states.append, **FAST
    )
    killer.join()
    assert remaining[0] > 20, "killed too late"
    assert (summary.ok + summary.exists, summary.failed) == (count, 1)
    rows = rows_of(report)
    assert sorted(row["source"] for row in rows) == sorted(map(str, pictures.rglob("*.png")))
    assert [row["error"] for row in rows if row["status"] == "failed"] == [
        "UnidentifiedImageError: not an image that Pillow reads"
    ]
    assert len({row["worker"] for row in rows}) >= 4
    check_outputs(rows)
    check_nothing_else(out, rows)
    assert {path.suffix for path in report.iterdir()} == {".parquet", ".json"}
    assert states[-1].done == states[-1].total == count + 1 and states[-1].failed == 1
    assert gscl.batch.read_report(str(report)).num_rows == count + 1

    again = gscl.batch.run(f"{pictures}/**/*.png", str(out), str(report), client=client, **FAST)
    assert (again.ok, again.exists, again.skipped, again.failed) == (0, 0, count, 1)
    assert gscl.batch.read_report(str(report)).num_rows == count + 1


def test_same_files_as_alone(client, tmp_path):
    """What a worker writes is what gscl.encode makes of the picture."""
    pictures = write_pictures(tmp_path / "pictures", 2)
    gscl.batch.run(f"{pictures}/*/*.png", str(tmp_path / "out"), str(tmp_path / "report"), client=client, **FAST)
    for path in pictures.rglob("*.png"):
        output = tmp_path / "out" / path.relative_to(pictures).with_suffix(".gscl")
        assert output.read_bytes() == gscl.encode(path, **FAST)


def test_picture_that_kills_its_worker(tmp_path):
    """It becomes a row, and so do the others of its task, though those at work beside it die with it."""
    names = [f"{i}" for i in range(12)]
    for name in names:
        (tmp_path / name).write_text("fatal" if name == "5" else "harmless")
    encoded = gscl.encode(make_picture(32, 32), **FAST)

    def encoder(picture, *, device):
        time.sleep(0.2)  # so that others are under way
        if picture == b"fatal":
            os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(0.2)
        return encoded

    with (
        distributed.LocalCluster(
            n_workers=1, threads_per_worker=3, dashboard_address="127.0.0.1:0", silence_logs=50
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        cluster.scheduler.allowed_failures = 0
        summary = gscl.batch.run(
            [str(tmp_path / name) for name in names],
            str(tmp_path / "out"),
            str(tmp_path / "report"),
            client=client,
            root=str(tmp_path),
            encoder=encoder,
        )
    assert (summary.ok + summary.exists, summary.failed) == (11, 1)
    rows = rows_of(tmp_path / "report")
    assert sorted(row["source"] for row in rows) == sorted(str(tmp_path / name) for name in names)
    (failed,) = [row for row in rows if row["status"] == "failed"]
    assert failed["source"] == str(tmp_path / "5") and "the worker died" in failed["error"]
    check_outputs(rows)


# ---- A worker in this process, with files in memory ------------------------------------------------


@pytest.fixture(scope="module")
def thread():
    """A worker of two encoders in this process."""
    with distributed.LocalCluster(
        n_workers=1, threads_per_worker=2, processes=False, dashboard_address="127.0.0.1:0"
    ) as cluster:
        with distributed.Client(cluster) as client:
            yield client


@pytest.fixture
def memory():
    filesystem = fsspec.filesystem("memory")
    filesystem.store.clear()
    filesystem.pseudo_dirs[:] = [""]
    yield filesystem
    filesystem.store.clear()


@pytest.fixture(scope="module")
def encoded():
    return gscl.encode(make_picture(32, 32), **FAST)


class Encoder:
    """Returns the same file for each picture, and counts its calls.  Fails as the picture says."""

    def __init__(self, encoded):
        self.encoded, self.calls, self.lock = encoded, collections.Counter(), threading.Lock()

    def __call__(self, picture, *, device, **settings):
        with self.lock:
            self.calls[picture] += 1
        if picture == b"device" or (picture == b"once" and self.calls[picture] == 1):
            raise gscl.DeviceFailedError("a call of OpenCL failed")
        if picture == b"bad":
            raise ValueError("a bad\npicture")
        return self.encoded

    def __reduce__(self):
        return _find_encoder, (id(self),)  # the same object in the worker, which is in this process


_encoders = {}


def _find_encoder(key):
    return _encoders[key]


@pytest.fixture
def encoder(encoded):
    made = Encoder(encoded)
    _encoders[id(made)] = made
    yield made
    _encoders.clear()


@pytest.fixture
def run(thread, encoder, monkeypatch):
    monkeypatch.setattr(gscl.batch._work, "PAUSE", 0)

    def run(pictures, **options):
        return gscl.batch.run(
            pictures,
            **{"out": "memory://out", "report": "memory://report", "client": thread, "encoder": encoder, **options},
        )

    return run


def table():
    return {row["source"]: row for row in gscl.batch.read_report("memory://report").to_pylist()}


def test_glob_of_a_url(run, memory):
    for name in "/in/a/x.png", "/in/a/b/y.jpg", "/in/z.png", "/in/z.txt", "/else/w.png":
        memory.pipe_file(name, name.encode())
    summary = run("memory://in/**/*.[pj][np]g")
    assert (summary.ok, summary.failed) == (3, 0)
    assert set(table()) == {"memory:///in/a/x.png", "memory:///in/a/b/y.jpg", "memory:///in/z.png"}
    assert set(memory.find("/out")) == {"/out/a/x.gscl", "/out/a/b/y.gscl", "/out/z.gscl"}
    assert run("memory://in/*.png", out="memory://flat", report="memory://other").ok == 1


def test_manifest(run, memory, tmp_path):
    """Names with spaces, twice, below the root and elsewhere, in a compressed file."""
    for name in "/in/a 1.png", "/in/b.png", "/else/c.png":
        memory.pipe_file(name, name.encode())
    manifest = tmp_path / "names.txt.gz"
    text = "a 1.png\n\nmemory://in/b.png\r\nmemory:///else/c.png\nb.png\n"
    with fsspec.open(str(manifest), "wt", compression="gzip", newline="") as file:
        file.write(text)
    summary = run(str(manifest), root="memory://in")
    assert (summary.ok, summary.repeated, summary.failed) == (3, 1, 0)
    assert set(memory.find("/out")) == {"/out/a 1.gscl", "/out/b.gscl", "/out/else/c.gscl"}


def test_bad_pictures(run, memory, encoder):
    """Lasting errors are not tried again, others are."""
    for name in "good", "bad", "once", "device":
        memory.pipe_file(f"/in/{name}", name.encode())
    names = [f"memory://in/{name}" for name in ("good", "bad", "once", "device", "missing")]
    summary = run(names, root="memory://in", retries=2)
    assert (summary.ok, summary.failed) == (2, 3)
    rows = {source.rpartition("/")[2]: row for source, row in table().items()}
    assert {name: row["attempts"] for name, row in rows.items()} == {
        "good": 1,
        "bad": 1,
        "once": 2,
        "device": 3,
        "missing": 1,
    }
    assert rows["bad"]["error"] == "ValueError: a bad picture"
    assert rows["device"]["error"] == "DeviceFailedError: a call of OpenCL failed"
    assert rows["missing"]["error"].startswith("FileNotFoundError")
    assert all((row["status"] == "ok") == (row["error"] is None) for row in rows.values())
    assert (rows["good"]["width"], rows["good"]["source_bytes"]) == (32, 4)
    assert rows["good"]["splats"] == encoder.encoded.report.splats


def test_resume(run, memory, encoder, encoded):
    """Rows that say so and outputs that are whole are done; damaged outputs and failed pictures are not."""
    for i in range(6):
        memory.pipe_file(f"/in/{i}.png", b"%d" % i)
    memory.pipe_file("/in/5.png", b"bad")
    memory.pipe_file("/out/0.gscl", encoded)
    memory.pipe_file("/out/1.gscl", encoded[:-1])
    first = run("memory://in/[0125].png")
    assert (first.ok, first.exists, first.skipped, first.failed) == (2, 1, 0, 1)
    assert memory.cat_file("/out/1.gscl") == encoded
    memory.pipe_file("/in/5.png", b"5")
    second = run("memory://in/*.png")
    assert (second.ok, second.exists, second.skipped, second.failed) == (3, 0, 3, 0)
    assert set(encoder.calls.values()) == {1}
    assert [row["status"] for row in table().values()].count("ok") == 5 and len(table()) == 6
    assert len(memory.ls("/report")) > 2 and gscl.batch.read_report("memory://report", ["bytes"]).num_columns == 1
    assert run("memory://in/*.png", overwrite=True).ok == 6
    assert len(table()) == 6


def test_task_that_ran_already(thread, memory, encoder):
    """A task whose rows are there does nothing, as when its worker dies after it wrote them."""
    memory.pipe_file("/in/a", b"a")
    job = gscl.batch._work.Job("0001-0", "memory:///out", "memory:///report", _conversions.Encoding({}, encoder))
    line = '["memory:///in/a", "memory:///out/a.gscl", ""]\n'
    counts = [thread.submit(gscl.batch._work.do_task, job, "0", line, pure=False).result() for _ in "12"]
    assert counts[0] == counts[1] == {"ok": 1, "exists": 0, "failed": 0, "bytes": len(encoder.encoded)}
    assert encoder.calls[b"a"] == 1


def test_two_pictures_with_one_output(run, memory):
    for name in "a.png", "a.jpg", "b.png":
        memory.pipe_file(f"/in/{name}", name.encode())
    summary = run(
        ["memory://in/a.png", "memory://in/a.jpg", "memory://in/b.png", "memory://in/../x"], root="memory://in"
    )
    assert (summary.ok, summary.failed) == (2, 2)
    assert "another file has the output a.gscl" in table()["memory:///in/a.jpg"]["error"]


def test_shards(run, memory):
    """Each picture is in one shard, wherever two are that have one output."""
    for i in range(40):
        memory.pipe_file(f"/in/{i}.png", b"%d" % i)
    parts = [run("memory://in/*", shard=(i, 3)).ok for i in (1, 2, 3)]
    assert sum(parts) == 40 and min(parts) > 4
    assert len(table()) == 40
    with pytest.raises(gscl.InvalidArgumentError, match="shard"):
        run("memory://in/*", shard=(0, 3))


def test_other_settings(run, memory):
    memory.pipe_file("/in/a", b"a")
    run("memory://in/*", bytes=100)
    with pytest.raises(gscl.ConflictError, match="bytes 100, now 200"):
        run("memory://in/*", bytes=200)


def test_wrong_settings():
    for settings, error in ({"bytes": 1, "bpp": 1}, gscl.ConflictError), ({"tune": "x"}, gscl.InvalidArgumentError):
        with pytest.raises(error):
            gscl.batch.run([], "memory://out", "memory://report", **settings)


def test_targets_that_small_pictures_miss():
    """They are no error of the run, as the test of settings takes a picture of a few pixels."""
    for target in {"bpp": 0.05}, {"bytes": 20}, {"psnr": 90.0}:
        assert gscl.batch.run([], "memory://out", "memory://small", **target).failed == 0
        fsspec.filesystem("memory").rm("/small", recursive=True)


@pytest.mark.parametrize("threads, expected", [(None, 1), (3, 3)])
def test_threads(run, memory, monkeypatch, encoded, threads, expected):
    """A picture takes one thread, unless the caller says otherwise, which changes no file: a run with another number goes on."""
    used = []

    def encode(picture, *, threads, progress=None, **_):
        if not progress:  # which the test of settings passes
            used.append(threads)
        return encoded

    monkeypatch.setattr(_conversions, "encode", encode)
    with io.BytesIO() as file:
        Image.fromarray(make_picture(32, 32)).save(file, "png")
        for name in "ab":
            memory.pipe_file(f"/in/{name}", file.getvalue())
    run(["memory://in/a"], root="memory://in", encoder=None, threads=threads, bytes=200)
    assert run("memory://in/*", encoder=None, threads=2, bytes=200).skipped == 1
    assert used == [expected, 2]


@pytest.mark.parametrize(
    "pictures, workers, encoders, expected",
    [
        (100, None, None, (8, 1, 1)),
        (2, None, None, (8, 1, 4)),
        (100, 2, None, (2, 4, 1)),
        (100, None, 2, (4, 2, 1)),
        (100, 1, 2, (1, 2, 4)),
        (1, 16, None, (16, 1, 8)),
        (100, 16, 2, (16, 2, 1)),
    ],
)
def test_shares_of_the_machine(monkeypatch, pictures, workers, encoders, expected):
    """Processes, pictures in each, and threads for each picture, on eight cores."""
    monkeypatch.setattr(gscl.batch._run.dask.system, "CPU_COUNT", 8)
    assert gscl.batch._run._divide(pictures, workers, encoders) == expected


def test_unknown_device(run, memory, tmp_path):
    """It is an error of the run, not of each picture."""
    Image.fromarray(make_picture(32, 32)).save(tmp_path / "picture.png")
    with pytest.raises(gscl.UnknownDeviceError, match="nothing"):
        run([str(tmp_path / "picture.png")], encoder=None, devices=["nothing"], retries=0)
    assert table() == {}


def test_storage_that_cannot_be_written(run, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="file"):
        run([], report=str(tmp_path / "file/report"))


def test_no_report(memory):
    with pytest.raises(FileNotFoundError, match="no report"):
        gscl.batch.read_report("memory://nothing")


def test_an_exception_ends_the_run(run, memory):
    """The next call completes it."""
    for i in range(40):
        memory.pipe_file(f"/in/{i}", b"%d" % i)

    def stop(state):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        run("memory://in/*", progress=stop, task_files=1)
    run("memory://in/*", task_files=1)
    assert len(table()) == 40


# ---- Fields --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def blends():
    """A file in each blend."""
    channels = {"normalized": 3, "sum": 1, "alpha": 4}
    return {
        blend: gscl.encode(make_picture(60, 40, count), bytes=300, effort=0, blend=blend)
        for blend, count in channels.items()
    }


def npz_of(data):
    with io.BytesIO() as memory:
        gscl.fields.save_npz(gscl.read_field(data), memory)
        return memory.getvalue()


COLOURS = "red", "green", "blue", "alpha"


def table_of(data):
    """The description of a field, the names of its columns and its rows, as `gscl export` writes them."""
    field = gscl.read_field(data)
    said = [f"{name}={getattr(field, name)}" for name in ("width", "height", "channels", "blend")]
    said += ["background=" + ",".join(map(repr, field.background)), "steps=" + ",".join(map(str, field.steps))]
    said += ["mean"] * field.has_mean_background
    columns = {name: field.splats[name] for name in gscl.SPLAT_DTYPE.names if name != "colour"}
    columns |= {name: field.splats["colour"][:, i] for i, name in enumerate(COLOURS)}
    return "gscl " + " ".join(said), list(columns), [list(map(str, row)) for row in zip(*columns.values())]


def csv_of(data):
    said, names, rows = table_of(data)
    return "\n".join(["# " + said, *(",".join(row) for row in [names, *rows]), ""]).encode()


def ply_of(data):
    said, names, rows = table_of(data)
    head = ["ply", "format ascii 1.0", "comment " + said, f"element vertex {len(rows)}"]
    head += [f"property float {name}" for name in names]
    return "\n".join([*head, "end_header", *(" ".join(row) for row in rows), ""]).encode()


def rows_by_name(report):
    return {row["source"].rpartition("/")[2]: row for row in gscl.batch.read_report(report).to_pylist()}


def contents(memory, folder):
    return {name: memory.cat_file(name) for name in memory.find(folder)}


def test_fields_are_packed_and_unpacked(thread, memory, blends):
    """To the bytes of the files that they are of; what is no field becomes a row."""
    first, second, third = blends.values()
    for name, content in {
        "a/1.npz": npz_of(first),
        "a/2.csv": csv_of(second),
        "3.PLY": ply_of(third),
        "damaged.npz": npz_of(first)[:-30],
        "bad.csv": b"x,y\n1,2\n",
        "other.txt": b"",
    }.items():
        memory.pipe_file(f"/in/{name}", content)

    def pack(report="memory://report", sources="memory://in/**", out="memory://packed", **options):
        return gscl.batch.pack(sources, out, report, client=thread, **options)

    summary = pack()
    assert (summary.ok, summary.failed) == (3, 3)
    packed = {"/packed/a/1.gscl": first, "/packed/a/2.gscl": second, "/packed/3.gscl": third}
    assert contents(memory, "/packed") == packed
    rows = rows_by_name("memory://report")
    assert {name: row["error"] for name, row in rows.items() if row["status"] == "failed"} == {
        "damaged.npz": "InvalidArgumentError: memory:///in/damaged.npz: is no NPZ file of arrays of numbers",
        "bad.csv": "InvalidArgumentError: memory:///in/bad.csv: has no column sigma1 and sigma2 (or cov_xx, cov_xy, cov_yy, "
        "or l11, l21, l22), red, green, blue",
        "other.txt": "InvalidArgumentError: the name ends with none of .npz, .csv, .ply: give a loader",
    }
    row, report = rows["1.npz"], gscl.pack(gscl.read_field(first)).report
    assert (row["width"], row["height"], row["splats"], row["psnr"]) == (60, 40, report.splats, report.psnr)
    assert (row["source_bytes"], row["bytes"], row["ssimulacra2"]) == (len(npz_of(first)), len(first), None)
    assert row["device"] == "default" and row["seconds"] > 0

    again = pack()
    assert (again.ok, again.exists, again.skipped, again.failed) == (0, 0, 3, 3)
    memory.pipe_file("/packed/3.gscl", third[:-1])
    anew = pack("memory://other")
    assert (anew.ok, anew.exists, anew.failed) == (1, 2, 3) and contents(memory, "/packed") == packed
    with pytest.raises(gscl.ConflictError, match="blend None, now 'sum'"):
        pack(blend="sum")

    def unpack(report):
        return gscl.batch.unpack("memory://packed/**/*.gscl", "memory://unpacked", report, client=thread)

    with pytest.raises(gscl.ConflictError, match="conversion 'pack', now 'unpack'"):
        unpack("memory://report")
    memory.pipe_file("/packed/bad.gscl", third[:-1])
    summary = unpack("memory://unpacking")
    assert (summary.ok, summary.failed) == (3, 1)
    rows = rows_by_name("memory://unpacking")
    assert rows["bad.gscl"]["error"].startswith(("TruncatedError: ", "DamagedError: "))
    row = rows["2.gscl"]
    assert (row["status"], row["output"], row["device"]) == ("ok", "memory:///unpacked/a/2.npz", None)
    assert (row["width"], row["height"], row["splats"], row["psnr"]) == (60, 40, gscl.info(second).splats, None)
    assert row["bytes"] == memory.size("/unpacked/a/2.npz") and row["source_bytes"] == len(second)
    assert unpack("memory://unpacking").skipped == 3
    memory.pipe_file("/unpacked/3.npz", memory.cat_file("/unpacked/3.npz")[:-1])
    anew = unpack("memory://unpacking-anew")
    assert (anew.ok, anew.exists, anew.failed) == (1, 2, 1)
    assert pack("memory://repacking", "memory://unpacked/**", "memory://repacked").ok == 3
    assert set(contents(memory, "/repacked").values()) == set(packed.values())


def test_settings_of_packing(thread, memory, blends):
    """Those of gscl.pack, and what a table does not say."""
    content = csv_of(blends["sum"]).split(b"\n", 1)[1]  # without its description
    memory.pipe_file("/in/a.txt", content)
    options = {"size": (80, 50), "blend": "normalized", "background": (0.5,)}
    settings = {"bytes": 200, "channels": 3, "bare": True}
    for ok, exists in (1, 0), (0, 1):
        summary = gscl.batch.pack(
            ["memory://in/a.txt"],
            "memory://out",
            f"memory://report{ok}",
            loader="csv",
            client=thread,
            root="memory://in",
            **options,
            **settings,
        )
        assert (summary.ok, summary.exists) == (ok, exists)
    expected = gscl.pack(gscl.fields.load_csv(io.BytesIO(content), **options), **settings)
    assert memory.cat_file("/out/a.gscl") == expected and len(expected) <= 200
    assert gscl.batch.unpack("memory://out/*", "memory://npz", "memory://r1", client=thread).failed == 1
    assert gscl.batch.unpack("memory://out/*", "memory://npz", "memory://r2", client=thread, bare=True).ok == 1
    assert gscl.fields.load_npz(io.BytesIO(memory.cat_file("/npz/a.npz"))) == gscl.read_field(expected, bare=True)


def test_checkpoints_are_packed(thread, memory, monkeypatch):
    """PyTorch, which need not be there, is replaced by what reads a pickled dictionary of arrays."""
    torch = types.SimpleNamespace(load=lambda file, *, map_location, weights_only: pickle.load(file))
    monkeypatch.setitem(sys.modules, "torch", torch)
    model = {"_xyz": numpy.zeros((1, 2)), "_cholesky": numpy.full((1, 3), 4.0), "_features_dc": numpy.ones((1, 3))}
    for name in "a", "b":
        memory.pipe_file(f"/in/{name}/gaussian_model.pth.tar", pickle.dumps(model))
    memory.pipe_file("/in/c/gaussian_model.pth.tar", b"other")
    sizes = {"a": (64, 48), "b": (32, 24)}

    def load(file):
        return gscl.fields.load_gaussianimage(file, size=sizes[file.name.split("/")[-2]])

    for out, options in ("by-name", {"loader": "gaussianimage", "size": (64, 48)}), ("by-function", {"loader": load}):
        summary = gscl.batch.pack("memory://in/**", f"memory://{out}", f"memory://report-{out}", client=thread, **options)
        assert (summary.ok, summary.failed) == (2, 1)
    (failed,) = [row for row in gscl.batch.read_report("memory://report-by-name").to_pylist() if row["error"]]
    assert failed["error"].endswith("/in/c/gaussian_model.pth.tar: is no checkpoint of tensors and numbers alone")
    expected = {name: gscl.pack(gscl.fields.load_gaussianimage(model, size=size)) for name, size in sizes.items()}
    assert memory.cat_file("/by-name/a/gaussian_model.gscl") == expected["a"]
    assert memory.cat_file("/by-function/b/gaussian_model.gscl") == expected["b"]


@pytest.mark.parametrize(
    "settings, error, message",
    [
        ({"loader": "jpeg"}, gscl.InvalidArgumentError, "loader: 'jpeg': expected one of npz, csv, ply, gaussianimage, "),
        ({"loader": "image_gs"}, gscl.ConflictError, "image_gs: takes size"),
        ({"loader": "image_gs", "size": (9, 9), "blend": "sum"}, gscl.ConflictError, "no blend"),
        ({"loader": print, "size": (9, 9)}, gscl.ConflictError, "size: a function as loader"),
        ({"size": (9, 0)}, gscl.ImageSizeError, "9x0"),
        ({"blend": "add"}, gscl.InvalidArgumentError, "blend: 'add'"),
        ({"background": (1, 2)}, gscl.InvalidArgumentError, "background: 2 values"),
        ({"bytes": 9, "psnr": 30}, gscl.ConflictError, "bytes, psnr"),
        ({"tolerance": 2}, gscl.InvalidArgumentError, "tolerance"),
        ({"refine": 3}, gscl.ConflictError, "refine"),
        ({"reference": "a.png"}, gscl.InvalidArgumentError, "each field is its own reference"),
        ({"effort": 3}, TypeError, "effort"),
    ],
)
def test_wrong_settings_of_packing(memory, settings, error, message):
    """They end the run before it begins."""
    with pytest.raises(error, match=message):
        gscl.batch.pack([], "memory://out", "memory://report", **settings)
    assert not memory.exists("/report")


def test_targets_that_small_fields_miss(memory):
    for number, target in enumerate(({"bytes": 9}, {"bpp": 0.01}, {"psnr": 150.0, "refine": 2})):
        assert gscl.batch.pack([], "memory://out", f"memory://{number}", **target).failed == 0


def test_packing_checkpoints_needs_pytorch(memory, monkeypatch):
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(ImportError, match=r"packing checkpoints needs PyTorch: pip install 'gscl\[torch\]'"):
        gscl.batch.pack([], "memory://out", "memory://report", loader="gaussianimage", size=(9, 9))


# ---- Files ---------------------------------------------------------------------------------------


def test_write_whole(tmp_path, memory, monkeypatch):
    temporary = _storage.temporary_folder(str(tmp_path), "1")
    target = tmp_path / "new/folder/file"
    _storage.write_whole(str(target), b"first", temporary)
    monkeypatch.setattr(os, "fsync", lambda file: os.close(-1))
    with pytest.raises(OSError):
        _storage.write_whole(str(target), b"second", temporary)
    assert target.read_bytes() == b"first" and not list((tmp_path / ".gscl-1").iterdir())
    old = tmp_path / ".gscl-0"
    old.mkdir()
    os.utime(old, (1, 1))
    _storage.clean(str(tmp_path), "1")
    assert [path.name for path in tmp_path.iterdir()] == ["new"]


def test_a_server_moves(tmp_path):
    """A filesystem that can move, and is none of objects, gets the file under another name first."""
    moves = []

    class Server(DirFileSystem):
        protocol = "server"

        def mv(self, source, target, **options):
            moves.append((source, target))
            os.replace(tmp_path / source.lstrip("/"), tmp_path / target.lstrip("/"))

    fsspec.register_implementation("server", Server, clobber=True)
    filesystem = Server(path=str(tmp_path), fs=fsspec.filesystem("file"))
    monkey = pytest.MonkeyPatch()
    with monkey.context() as patch:
        patch.setattr(_storage, "open_url", lambda url: (filesystem, url.partition("://")[2]))
        _storage.write_whole("server://out/a/x", b"data", "server://out/.gscl-1")
    assert (tmp_path / "out/a/x").read_bytes() == b"data" and len(moves) == 1


@pytest.mark.parametrize(
    "name, root, source, output",
    [
        ("/p/a.b.png", "/p", "/p/a.b.png", "a.b.gscl"),
        ("x/a", "/p", "/p/x/a", "x/a.gscl"),
        ("x/model.pth.tar", "/p", "/p/x/model.pth.tar", "x/model.gscl"),
        ("/q/a.png", "/p", "/q/a.png", "q/a.gscl"),
        ("/p2/a.png", "/p", "/p2/a.png", "p2/a.gscl"),
        (".hidden", "/p", "/p/.hidden", ".hidden.gscl"),
        ("memory://b/a.png", "", "memory:///b/a.png", "b/a.gscl"),
        ("a.png", "memory:///b", "memory:///b/a.png", "a.gscl"),
        ("zip://x/a.png::/p/z.zip", "", "zip://x/a.png::/p/z.zip", "x/a.gscl"),
    ],
)
def test_names(name, root, source, output):
    assert _plan.locate(name, root, ".gscl") == (source, output)


def test_glob_matches_as_fsspec_does(tmp_path):
    for name in "a/b/c.png", "a/c.png", "c.png", "a/b/c.txt", "a/[x].png":
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    for pattern in "**/*.png", "*.png", "*/*.png", "a/**", "?/?/c.*", "**/[[]x].png", "none/*":
        expected = [name for name in fsspec.filesystem("file").glob(f"{tmp_path}/{pattern}") if os.path.isfile(name)]
        assert sorted(_plan.list_sources(f"{tmp_path}/{pattern}")) == sorted(expected), pattern


def test_places_of_devices(tmp_path, monkeypatch):
    """Processes take devices in turn; the place of one that ended, whose files the system closes, is taken next."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    claims = [_machine._claim(("0.0", "b/c")) for _ in range(3)]
    assert [device for device, _ in claims] == ["0.0", "b/c", "0.0"]
    claims[1][1].close()
    claims.append(_machine._claim(("0.0", "b/c")))
    assert claims[3][0] == "b/c"
    assert _machine.choose_device(("0.0", "b/c")) == _machine.choose_device(("0.0", "b/c")) == "b/c"
    for _, file in [*claims, _machine._claims.pop(("0.0", "b/c"))]:
        file.close()
    assert _machine.choose_device(("only",)) == "only"


# ---- The program ---------------------------------------------------------------------------------


def batch(*arguments, **environment):
    command = [sys.executable, "-m", "gscl.batch", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, env={**os.environ, **environment})


def test_program(tmp_path):
    """Two workers on two devices, of which PoCL makes as many as it is asked for; then the same again."""
    pictures = write_pictures(tmp_path / "pictures", 24)
    (pictures / "a/bad.png").write_text("no picture")
    arguments = [f"{pictures}/**/*.png", "--out", tmp_path / "out", "--report", tmp_path / "report"]
    arguments += ["--effort", "0", "--bytes", "200", "--workers", "2", "--device", "0.0", "--device", "0.1"]
    done = batch(*arguments, POCL_DEVICES="pthread pthread", TMPDIR=str(tmp_path))
    assert (done.returncode, done.stdout[:47]) == (1, "24 encoded, 0 existed, 0 done before, 1 failed;"), done.stderr
    assert "100% 25/25, 1 failed" in done.stderr
    rows = gscl.batch.read_report(str(tmp_path / "report")).to_pylist()
    assert {row["device"] for row in rows} == {"0.0", "0.1"}
    assert len({(row["worker"], row["device"]) for row in rows}) == 2
    check_outputs(rows)
    (pictures / "a/bad.png").unlink()
    again = batch(*arguments, "--quiet")
    assert (again.returncode, again.stdout[:47], again.stderr) == (
        0,
        "0 encoded, 0 existed, 24 done before, 0 failed;",
        "",
    )
    assert statuses(tmp_path / "report") == {"ok": 24, "failed": 1}


def test_program_packs_and_unpacks(tmp_path, blends):
    """What was packed is unpacked; a second run does nothing."""
    fields = tmp_path / "fields"
    fields.mkdir()
    for name, content in {"1.npz": npz_of(blends["sum"]), "2.csv": csv_of(blends["alpha"]), "3.csv": b"bad"}.items():
        (fields / name).write_bytes(content)
    packed, unpacked = tmp_path / "packed", tmp_path / "unpacked"
    pack = "--pack", f"{fields}/*", "--out", packed, "--report", tmp_path / "packing", "--workers", 1, "--device", "host"
    done = batch(*pack)
    assert (done.returncode, done.stdout[:45]) == (1, "2 packed, 0 existed, 0 done before, 1 failed;"), done.stderr
    assert "100% 3/3, 1 failed" in done.stderr
    assert [path.read_bytes() for path in sorted(packed.iterdir())] == [blends["sum"], blends["alpha"]]
    (fields / "3.csv").unlink()
    done = batch(*pack, "--quiet")
    assert (done.returncode, done.stdout[:45]) == (0, "0 packed, 0 existed, 2 done before, 0 failed;"), done.stderr
    done = batch("--unpack", f"{packed}/*", "--out", unpacked, "--report", tmp_path / "unpacking", "--workers", 1)
    assert (done.returncode, done.stdout[:47]) == (0, "2 unpacked, 0 existed, 0 done before, 0 failed;"), done.stderr
    assert [gscl.pack(gscl.fields.load_npz(path)) for path in sorted(unpacked.iterdir())] == list(blends.values())[1:]


def test_options_of_packing(monkeypatch, capsys):
    """They are the arguments of gscl.batch.pack."""
    given = {}

    def pack(*_, **options):
        given.update(options)
        return gscl.batch.Summary(1, 2, 3, 4, 5, 6, 7)

    monkeypatch.setitem(batch_kinds, "pack", batch_kinds["pack"]._replace(call=pack))
    arguments = "--pack x --out o --report r --loader csv --size 80x50 --blend sum --background 0.5,0,1 --no-passes --refine 2"
    status, output, _ = main(capsys, *arguments.split(), *"--tolerance 0.1 --psnr 30 --bare --threads 2 --device host".split())
    assert (status, output) == (1, "1 packed, 2 existed, 4 done before, 3 failed; 6 bytes, 7.0 s\n")
    expected = {"loader": "csv", "size": (80, 50), "blend": "sum", "background": (0.5, 0, 1), "passes": False, "refine": 2}
    expected |= {"tolerance": 0.1, "psnr": 30, "bare": True, "threads": 2, "devices": ["host"]}
    assert expected.items() <= given.items() and not {"effort", "bytes", "exif"} & set(given)


def main(capsys, *arguments):
    """The program in this process: its status, output and errors."""
    with pytest.raises(SystemExit) as ended:
        sys.exit(batch_main(list(map(str, arguments))))
    return (ended.value.code, *capsys.readouterr())


def test_wrong_commands(tmp_path, capsys, monkeypatch):
    paths = "--out", tmp_path / "out", "--report", tmp_path / "report"
    for arguments, text in {
        ("x",): "--out",
        ("x", *paths, "--shard", "3/2"): "3/2",
        ("x", *paths, "--bytes", "1", "--bpp", "1"): "not allowed with",
        ("x", *paths, "--pack", "--unpack"): "not allowed with",
        ("x", *paths, "--pack", "--effort", "1", "--exif"): "--effort, --exif: has no meaning with --pack",
        ("x", *paths, "--unpack", "--bytes", "9"): "--bytes: has no meaning with --unpack",
        ("x", *paths, "--unpack", "--device", "host"): "--device: has no meaning with --unpack",
        ("x", *paths, "--no-passes"): "--no-passes: has no meaning without --pack",
        ("x", *paths, "--pack", "--size", "9"): "expected WxH",
        ("x", *paths, "--pack", "--loader", "jpeg"): "jpeg",
        ("x", *paths, "--scheduler", "tcp://127.0.0.1:1", "--workers", "2"): "dask worker",
    }.items():
        status, _, errors = main(capsys, *arguments)
        assert status == 2 and text in errors
    monkeypatch.setitem(sys.modules, "torch", None)
    Image.new("RGB", (8, 8)).save(tmp_path / "picture.png")
    for name, options, text in (
        (tmp_path / "nothing.txt", (), "nothing.txt"),
        (tmp_path / "picture.png", (), "picture.png is no text with a name in each line"),
        ("x", ("--seed", "-1"), "seed"),
        ("x", ("--pack", "--tolerance", "2"), "tolerance"),
        ("x", ("--pack", "--loader", "image_gs", "--size", "9x9"), "needs PyTorch"),
    ):
        status, _, errors = main(capsys, name, *paths, *options)
        assert status == 1 and text in errors and errors.count("\n") == 1
    assert "a glob, in quotes" in main(capsys, "--help")[1]
