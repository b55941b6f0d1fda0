"""Encodes many pictures, or packs or unpacks many fields, on the machines of a Dask cluster.

    import gscl.batch
    gscl.batch.run("s3://bucket/photos/**/*.jpg", "s3://bucket/gscl", "s3://bucket/report", bpp=0.1)
    gscl.batch.pack("fields/*.npz", "packed", "report-of-packing", psnr=32)
    gscl.batch.unpack("packed/*.gscl", "unpacked", "report-of-unpacking")
    table = gscl.batch.read_report("s3://bucket/report")

Needs the packages of `pip install gscl[batch]`.  As a program: python -m gscl.batch --help.
"""

try:
    from gscl.batch._conversions import encode_file
    from gscl.batch._functions import pack, run, unpack
    from gscl.batch._report import SCHEMA, read_report
    from gscl.batch._run import BatchProgress, Summary
except ModuleNotFoundError as error:
    raise ImportError(f"gscl.batch needs further packages: pip install 'gscl[batch]': {error}") from error

__all__ = ["BatchProgress", "encode_file", "pack", "read_report", "run", "SCHEMA", "Summary", "unpack"]
