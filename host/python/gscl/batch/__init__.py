"""Encodes many pictures on the machines of a Dask cluster.

    import gscl.batch
    gscl.batch.run("s3://bucket/photos/**/*.jpg", "s3://bucket/gscl", "s3://bucket/report", bpp=0.1)
    table = gscl.batch.read_report("s3://bucket/report")

Needs the packages of `pip install gscl[batch]`.  As a program: python -m gscl.batch --help.
"""

try:
    from gscl.batch._conversions import encode_file
    from gscl.batch._functions import run
    from gscl.batch._report import SCHEMA, read_report
    from gscl.batch._run import BatchProgress, Summary
except ModuleNotFoundError as error:
    raise ImportError(f"gscl.batch needs further packages: pip install 'gscl[batch]': {error}") from error

__all__ = ["BatchProgress", "encode_file", "read_report", "run", "SCHEMA", "Summary"]
