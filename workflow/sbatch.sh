#!/usr/bin/env bash
# A sweep as one job of Slurm, without Snakemake; submit it again to go on (docs/cluster.md).
#
#   sbatch --partition=main workflow/sbatch.sh config/default.yaml
#
# Run it from the checkout; the results stand in results/.
#SBATCH --job-name=crackfront
#SBATCH --ntasks=33               # ranks: one hands out the work, the others simulate
#SBATCH --cpus-per-task=1
#SBATCH --mem-per-cpu=1000M       # the largest "MB a rank" of `crackfront plan`, half as much again
#SBATCH --time=04:00:00
#SBATCH --signal=TERM@120         # seconds before the limit: store what runs, then stop
set -euo pipefail

sweep=${1:?"name a configuration: sbatch workflow/sbatch.sh config/default.yaml"}
# module load mpich               # what the site needs before a job starts
export PATH="$PWD/.venv/bin:$PATH" OMP_NUM_THREADS=1

# pmi2 for MPICH's wheel (`make env`), often pmix for the site's MPI (`make env MPI=system`).
srun -K1 --mpi=pmi2 crackfront simulate "$sweep"
crackfront aggregate "$sweep"
crackfront fit "$sweep"
crackfront checksums "results/$(basename "${sweep%.*}")"
