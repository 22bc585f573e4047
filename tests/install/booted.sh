#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# booted.sh ROOT COMMAND...: starts the systemd of a root file system in namespaces of its own, runs the command with it, and
# ends both. Status 77: it does not start here. The devices are its own too; nothing is left outside of ROOT.
set -euo pipefail
root=$1
shift
# shellcheck disable=SC2016 # its own $0
unshare --mount --pid --fork --kill-child --cgroup --uts --ipc bash -euc '
  mount --bind "$0" "$0"
  cd "$0"
  mount -t proc proc proc
  mount -t sysfs -o ro sysfs sys
  mount -t cgroup2 cgroup2 sys/fs/cgroup
  mount -t tmpfs tmpfs run
  mount -t tmpfs -o mode=755 tmpfs dev
  for node in null:3 zero:5 full:7 random:8 urandom:9; do mknod -m 666 "dev/${node%:*}" c 1 "${node#*:}"; done
  mknod -m 666 dev/tty c 5 0
  mkdir dev/pts dev/shm
  mount -t devpts -o newinstance,ptmxmode=666 devpts dev/pts
  ln -s pts/ptmx dev/ptmx
  ln -s /proc/self/fd dev/fd
  mkdir -p old
  pivot_root . old
  umount -l /old
  exec env -i container=other PATH=/usr/sbin:/usr/bin:/sbin:/bin /lib/systemd/systemd --system' "$root" < /dev/null > /dev/null 2>&1 &
holder=$!
trap 'kill -9 $holder 2> /dev/null || true; wait 2> /dev/null || true' EXIT
beside() { nsenter -t "$(pgrep -P $holder)" --mount --uts --ipc --pid --cgroup "$@"; }
for _ in $(seq 100); do
  case $(beside systemctl is-system-running 2> /dev/null || true) in
    running|degraded) status=0; beside "$@" || status=$?; exit $status ;;
  esac
  sleep 0.2
done
exit 77
