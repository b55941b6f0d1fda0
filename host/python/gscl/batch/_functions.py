"""What callers start: a run for each conversion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import distributed

from gscl._names import Blend
from gscl.batch._conversions import Encoder, Encoding, Loader, LoaderName, Packing, Unpacking
from gscl.batch._plan import Sources
from gscl.batch._run import TASK_FILES, BatchProgress, Summary, convert_all


def run(
    pictures: Sources,
    out: str,
    report: str,
    *,
    client: distributed.Client | None = None,
    workers: int | None = None,
    encoders: int | None = None,
    threads: int | None = None,
    devices: Sequence[str] = (),
    root: str | None = None,
    shard: tuple[int, int] = (1, 1),
    retries: int = 2,
    overwrite: bool = False,
    task_files: int = TASK_FILES,
    encoder: Encoder | None = None,
    progress: Callable[[BatchProgress], None] | None = None,
    **settings: Any,
) -> Summary:
    """Encodes many pictures on the workers of a Dask cluster.

    pictures: a glob, a manifest, or a list, whose names are paths or URLs of fsspec.  A glob begins at its first "*",
        "?" or "[", and "**" stands for any folders; a manifest is a UTF-8 text, or a compressed one, with a name in
        each line.
    out: the folder of the outputs, which keeps the tree of the pictures: NAME.gscl for NAME.png.
    report: the folder of the report, which read_report reads.  It has a row a picture: source, output; status: "ok",
        "exists" (the output was there, and whole) or "failed"; error; source_bytes, bytes; width, height, splats, psnr;
        ssimulacra2, where it is the target; seconds, attempts, worker, device, and the time when it was finished.
    client: of the cluster; None starts worker processes on this machine for the time of the call.
    workers, encoders: with no client, how many processes, and how many pictures each encodes at the same time; None
        for as many as the machine has cores, in all.  With a client, each worker has as many encoders as Dask gave it
        threads.
    threads: of each encode on the device "host".  None for one, as other pictures take the other cores; where no client is
        given and pictures are fewer than encoders, for an even share of the cores.  An encoder of the caller's own does
        not get it.
    devices: ids or parts of names of OpenCL devices, which the workers of a machine share evenly, or "host"; empty for the
        GPUs of the default platform or, if it has none, the default device, which is "host".
    root: the folder in `pictures` that `out` stands for.  Relative names of a manifest are below it.  None for the
        folder that a glob begins with and, with a manifest, for the current folder; names elsewhere keep their whole
        path.
    shard: (i, n) for the i-th of n parts, 1..n, of all pictures.
    retries: further attempts for errors that may pass: those of storage and of OpenCL.
    overwrite: whether to encode pictures again whose outputs exist or whose rows say that they are done.
    task_files: the most files in a task, and rows in a file of the report.
    encoder: replaces gscl.encode; called with the bytes of a picture's file and, by name, `device` and the settings;
        returns what gscl.encode returns, or gscl.Encoded(data, report).
    progress: called about once a second, in the calling thread.  An exception in it ends the run.
    settings: arguments of gscl.encode.

    A picture that cannot be encoded is a row, and the run goes on.  A run that ended early, in whatever way, is
    completed by the same call: pictures whose rows say that they are done, or whose outputs are whole, are not encoded
    again; failed ones are.  Outputs and files of the report are written whole or not at all.

    Raises a subclass of gscl.Error for settings that no picture can have and for machines without a device, and OSError
    where names cannot be listed or the report not be written.
    """
    return convert_all(
        Encoding(settings, encoder),
        pictures,
        out,
        report,
        client=client,
        workers=workers,
        encoders=encoders,
        threads=threads,
        devices=devices,
        root=root,
        shard=shard,
        retries=retries,
        overwrite=overwrite,
        task_files=task_files,
        progress=progress,
    )


def pack(
    fields: Sources,
    out: str,
    report: str,
    *,
    loader: Loader | LoaderName | None = None,
    size: tuple[int, int] | None = None,
    blend: Blend | None = None,
    background: Sequence[float] | None = None,
    client: distributed.Client | None = None,
    workers: int | None = None,
    encoders: int | None = None,
    threads: int | None = None,
    devices: Sequence[str] = (),
    root: str | None = None,
    shard: tuple[int, int] = (1, 1),
    retries: int = 2,
    overwrite: bool = False,
    task_files: int = TASK_FILES,
    progress: Callable[[BatchProgress], None] | None = None,
    **settings: Any,
) -> Summary:
    """Packs many fields of Gaussians as files: NAME.gscl for NAME.npz, NAME.csv, NAME.ply, NAME.pth.tar, NAME.pt.

    fields: as the pictures of run.
    out, report, and the arguments from client to progress: as of run.
    loader: what reads them: the name of a function of gscl.fields without load_: "npz", "csv", "ply", "gaussianimage",
        "gaussianimage_plus" or "image_gs"; or a function that is called with a file, open, whose `name` is its URL or path, and
        returns a gscl.Field.  None for npz, csv or ply, as each name ends.
    size: (width, height) of all pictures, pixels: for checkpoints, which do not say it, and for tables that do not, or not the
        right one.  Where checkpoints have several sizes, a function as loader knows that of each name.
    blend, background: as of gscl.pack, for tables that do not say them, or not the right ones.
    settings: arguments of gscl.pack but for reference: each field is its own.

    A row's psnr is that of the file against the field.  All else is as in run.

    Raises a subclass of gscl.Error for settings that no field can have and for machines without a device, ImportError where
    checkpoints need PyTorch, and OSError where names cannot be listed or the report not be written.
    """
    given = {"size": size, "blend": blend, "background": background}
    return convert_all(
        Packing(settings, loader, {name: value for name, value in given.items() if value is not None}),
        fields,
        out,
        report,
        client=client,
        workers=workers,
        encoders=encoders,
        threads=threads,
        devices=devices,
        root=root,
        shard=shard,
        retries=retries,
        overwrite=overwrite,
        task_files=task_files,
        progress=progress,
    )


def unpack(
    files: Sources,
    out: str,
    report: str,
    *,
    bare: bool = False,
    client: distributed.Client | None = None,
    workers: int | None = None,
    encoders: int | None = None,
    root: str | None = None,
    shard: tuple[int, int] = (1, 1),
    retries: int = 2,
    overwrite: bool = False,
    task_files: int = TASK_FILES,
    progress: Callable[[BatchProgress], None] | None = None,
) -> Summary:
    """Reads the fields of many files: NAME.npz for NAME.gscl, as gscl.fields.save_npz writes it.

    files: as the pictures of run.
    out, report, and the arguments from client to progress: as of run.
    bare: whether the files were made with `bare`.

    Packing an output without a target gives the bytes of its file again, but for metadata, which an output does not have, and
    where the file is a list of packets or has the profile "paper".  Rows have neither psnr nor device.  All else is as in run.

    Raises OSError where names cannot be listed or the report not be written.
    """
    return convert_all(
        Unpacking(bare),
        files,
        out,
        report,
        client=client,
        workers=workers,
        encoders=encoders,
        threads=None,
        devices=(),
        root=root,
        shard=shard,
        retries=retries,
        overwrite=overwrite,
        task_files=task_files,
        progress=progress,
    )
