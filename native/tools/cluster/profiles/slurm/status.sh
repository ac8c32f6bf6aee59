#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# status.sh SLURM_JOB: prints success, failed or running, and always exits with 0. Works in the job folder of a plan and
# without Slurm's accounting. `failed` costs a retry, at worst of a piece that still runs, which is harmless; `success`
# is verified by Snakemake through the done file.
job=${1%%;*}
if ! shown=$(LC_ALL=C scontrol --oneliner show job "$job" 2>&1); then
  case $shown in
    *"Invalid job id"*)  # record dropped (MinJobAge) or lost: done if its log ends so
      if grep -qs '^done: ' "logs/slurm-$job.log"; then echo success; else echo failed; fi ;;
    *) echo running ;;  # no answer from the controller: retry later
  esac
  exit 0
fi
state=$(printf '%s\n' "$shown" | sed -n 's/.* JobState=\([A-Z_]*\).*/\1/p')
reason=$(printf '%s\n' "$shown" | sed -n 's/.* Reason=\([^ ]*\).*/\1/p')
case $state in
  COMPLETED) echo success ;;
  PENDING)
    case $reason in
      # These states would wait forever.
      launch_failed_requeued_held | BadConstraints | PartitionTimeLimit | *MaxWall* | *MaxMem*PerJob* | MaxMemPerLimit)
        echo "Slurm will not start job $job: $reason; --config most_minutes=N and most_mb=N bound what pieces ask for" \
          >>"logs/slurm-$job.log"
        scancel "$job" >/dev/null 2>&1
        echo failed ;;
      *) echo running ;;
    esac ;;
  RUNNING | COMPLETING | CONFIGURING | REQUEUED | REQUEUE_FED | REQUEUE_HOLD | RESIZING | SIGNALING | STAGE_OUT | \
    STOPPED | SUSPENDED)
    echo running ;;
  *) echo failed ;;  # NODE_FAIL, PREEMPTED, BOOT_FAIL, OUT_OF_MEMORY, TIMEOUT, CANCELLED, FAILED, DEADLINE, ...
esac
