#!/usr/bin/env python3
"""Runs gscl.batch on workers that are Slurm jobs: slurm_dask.py 'photos/**/*.jpg' OUT REPORT [JOBS [PARTITION]]

Needs `pip install dask-jobqueue`.  Each job is one process with as many encoders as it has cores.
"""
import sys

import distributed
import gscl.batch
from dask_jobqueue import SLURMCluster


def main():
    pictures, out, report = sys.argv[1:4]
    jobs = int(sys.argv[4]) if len(sys.argv) > 4 else 2
    partition = sys.argv[5] if len(sys.argv) > 5 else None
    with SLURMCluster(queue=partition, cores=1, processes=1, memory="2GB", walltime="08:00:00",
                      python=sys.executable, local_directory="/tmp") as cluster:
        cluster.scale(jobs=jobs)
        with distributed.Client(cluster) as client:
            print(gscl.batch.run(pictures, out, report, client=client))


if __name__ == "__main__":
    main()
