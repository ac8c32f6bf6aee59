#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs plans on a Slurm cluster of two nodes with one CPU each, all of it on this machine: its daemons start for the
# test, with state in a temporary folder, and end with it. As root, with Debian's snakemake, slurmctld, slurmd,
# slurm-client and munge. Prints per plan how many pieces ran, where, and which were tried again. The exit code is 1
# where a run fails, leaves a node idle or, with --kill, has nothing tried again.
#   bash tests/cluster/slurm.sh [--kill] JOB...
# JOB: a job folder, as `fourdvt plan` makes it. --kill: kills the tool of a running piece with SIGKILL, then drains
# node2 for a while. FOURDVT: the tool, if not the plan's. SLURM_CONF_LINES: further lines of slurm.conf.
set -euo pipefail
usage() { sed -n '7,9s/^# //p' "$0" >&2; exit 2; }
kill=
if [ "${1:-}" = --kill ]; then kill=1; shift; fi
[ $# -ge 1 ] || usage
jobs=()
for job; do jobs+=("$(realpath -e "$job")"); done

scratch=$(mktemp -d)
daemons=()
clean_up() {
  trap - EXIT
  # Ends what runs on a node with it, as each has its own process numbers.
  local daemon
  for daemon in "${daemons[@]}"; do pkill -KILL --parent "$daemon" || true; done
  wait 2>/dev/null || true
  rm -rf "$scratch"
}
trap clean_up EXIT
trap 'exit 130' INT TERM
fail() {
  echo "slurm.sh: $*" >&2
  tail -n 20 "$scratch"/*.log >&2
  exit 1
}

# Ports that are free now, so that a Slurm of this machine does not matter.
read -r port_control port_1 port_2 < <(/usr/bin/python3 -c '
import socket
sockets = [socket.socket() for _ in range(3)]
for each in sockets: each.bind(("127.0.0.1", 0))
print(*(each.getsockname()[1] for each in sockets))')
memory=$(awk '/^MemTotal:/ { print int($2 / 1024 / 2) }' /proc/meminfo)
mkdir "$scratch"/{state,spool-node1,spool-node2}
cat >"$scratch/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=control(127.0.0.1)
SlurmctldPort=$port_control
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$scratch/munge.socket
StateSaveLocation=$scratch/state
SlurmdSpoolDir=$scratch/spool-%n
SlurmctldPidFile=$scratch/slurmctld.pid
SlurmdPidFile=$scratch/slurmd-%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/filetxt
JobCompLoc=$scratch/ended
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SlurmdParameters=config_overrides
MpiDefault=none
MailProg=/bin/true
ReturnToService=2
KillWait=2
NodeName=node1 NodeAddr=127.0.0.1 Port=$port_1 CPUs=1 RealMemory=$memory
NodeName=node2 NodeAddr=127.0.0.1 Port=$port_2 CPUs=1 RealMemory=$memory
PartitionName=all Nodes=node1,node2 Default=YES MaxTime=INFINITE
${SLURM_CONF_LINES:-}
CONF
export SLURM_CONF=$scratch/slurm.conf

start() {  # HOST PROGRAM...: a daemon with a host name of its own
  unshare --uts --mount --pid --mount-proc --fork --kill-child \
    sh -c 'hostname "$0" && exec "$@"' "$@" >"$scratch/$1.log" 2>&1 &
  daemons+=($!)
}
head -c 128 /dev/urandom >"$scratch/munge.key"
chmod 400 "$scratch/munge.key"
start munge munged --foreground --force --key-file="$scratch/munge.key" --socket="$scratch/munge.socket" \
  --pid-file="$scratch/munged.pid" --log-file="$scratch/munged.log" --seed-file="$scratch/munge.seed"
for ((i = 0; i < 50; ++i)); do [ -S "$scratch/munge.socket" ] && break; sleep 0.1; done
start control slurmctld -D
start node1 slurmd -D
start node2 slurmd -D
for ((i = 0; ; ++i)); do
  [ "$(sinfo --noheader --partition=all --Node --format=%t 2>/dev/null | grep -c '^idle$')" = 2 ] && break
  [ $i -lt 100 ] || fail "the nodes do not come up: $(sinfo --Node 2>&1)"
  sleep 0.3
done

tool_of() {  # SLURM_JOB → process number of the tool that computes its piece
  local process argument
  for process in /proc/[0-9]*; do
    grep -qsz "^SLURM_JOB_ID=$1\$" "$process/environ" || continue
    while IFS= read -r -d '' argument; do
      [ "$argument" != piece ] || { echo "${process#/proc/}"; return; }
    done 2>/dev/null <"$process/cmdline"
  done
}
harm() {  # while Snakemake runs
  local job process=
  for ((i = 0; i < 600; ++i)); do
    for job in $(squeue --noheader --states=RUNNING --format=%A); do
      process=$(tool_of "$job")
      [ -z "$process" ] || { kill -KILL "$process" && break 2; }
    done
    sleep 0.1
  done
  [ -n "$process" ] || { echo "slurm.sh: found no tool to kill"; return; }
  echo "slurm.sh: killed the tool of Slurm's job $job, $(squeue --noheader --jobs="$job" --format='%j on %N')"
  scontrol update NodeName=node2 State=DRAIN Reason=test
  sleep 10
  echo "slurm.sh: node2 is $(sinfo --noheader --nodes=node2 --format=%T), goes back"
  scontrol update NodeName=node2 State=RESUME
}

status=0
for job in "${jobs[@]}"; do
  : >"$scratch/ended"
  # Threads are bounded by the nodes' one CPU.
  snakemake --directory "$job" --snakefile "$job/Snakefile" --profile "$job/profiles/slurm" --max-threads 1 \
    ${FOURDVT:+--config fourdvt="$FOURDVT"} >"$scratch/snakemake.log" 2>&1 &
  run=$!
  [ -z "$kill" ] || harm
  result=passed
  wait $run || { result=failed; tail -n 40 "$scratch/snakemake.log"; }
  # The lines of jobcomp/filetxt: JobId=1 ... Name=gop:gop-walk-3 JobState=COMPLETED ... NodeList=node1 ...
  awk -v job="$job" -v result=$result -v kill="$kill" '
    { delete field; for (i = 1; i <= NF; ++i) { at = index($i, "="); field[substr($i, 1, at - 1)] = substr($i, at + 1) }
      name = field["Name"]; sub(/^[^:]*:/, "", name)
      if (tried[name]++ == 1) again = again " " name
      ++ended[field["JobState"]]
      if (field["JobState"] == "COMPLETED") { if (!done[name]++) ++pieces; ++on[field["NodeList"]] } }
    END {
      printf "%s: %s, %d pieces:", job, result, pieces
      for (node in on) printf " %d on %s", on[node], node
      printf "; jobs:"; for (state in ended) printf " %d %s", ended[state], state
      printf "; tried again:%s\n", again == "" ? " none" : again
      exit result == "passed" && (pieces < 4 || length(on) == 2) && (!kill || again != "") ? 0 : 1
    }' "$scratch/ended" || status=1
done
exit $status
