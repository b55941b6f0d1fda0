"""What callers start: a run for each conversion."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import distributed

from gscl.batch._conversions import Encoder, Encoding
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
