#!/bin/bash
# A sweep as a job array of Slurm: each job runs a shard. A job that is killed or requeued goes on where it was.
#
#   jobs=$(sbatch --parsable --array=1-8 slurm.sh)
#   sbatch --dependency=afterok:$jobs --wrap 'feedbits merge sweep-*-of-8.jsonl --out all.jsonl --report maps'
#
#SBATCH --job-name=feedbits
#SBATCH --requeue
#SBATCH --open-mode=append
set -euo pipefail
srun feedbits sweep part.nc --machine mill.toml --period 0.5..4/4 --feed 20..100/4 --formats I8F24,I4F28,f32 \
    --shard "$SLURM_ARRAY_TASK_ID/$SLURM_ARRAY_TASK_COUNT" --quiet
