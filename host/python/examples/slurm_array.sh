#!/bin/sh
# Encodes the images of a list as a Slurm array, a share for each task:
#
#     sbatch --array=1-100 slurm_array.sh LIST OUT_DIR REPORT_DIR [OPTIONS OF gscl encode]
#
# A task that was killed, or whose node was lost, goes on when it is submitted again: sbatch --array=17 slurm_array.sh ...
#SBATCH --cpus-per-task=2
#SBATCH --requeue
set -u
list=$1
out=$2
report=$3
shift 3
mkdir -p "$report"
# Exit code 3: some images failed, and the report names them.
"${GSCL:-gscl}" encode --files-from "$list" --out-dir "$out" --keep-tree --skip-existing \
    --shard "$SLURM_ARRAY_TASK_ID/${SHARDS:-$SLURM_ARRAY_TASK_COUNT}" \
    --jsonl "$report/$SLURM_ARRAY_TASK_ID.jsonl" --threads "${SLURM_CPUS_PER_TASK:-1}" --quiet "$@"
