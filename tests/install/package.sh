#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Packs what the build tree has, and uses the packages as their users would, in a fresh Debian 12: the image of the
# Containerfile, a run, a user's plugin, purge. Status 77: it cannot be done here, for the reason that it prints.
set -euo pipefail
exec < /dev/null
cpack=$1 build=$2 source=$3
here=$(dirname "$0")
store=$build/package-test  # what is slow to get stays here: a fresh Debian, and the archives of other packages
work=$(mktemp -d "$build/package-test-XXXXXX")
trap 'rm -rf --one-file-system "$work"' EXIT

skip() { echo "skipped: $1"; exit 77; }
fail() { echo "package.sh: $1"; exit 1; }
step() { printf '%5d s  %s\n' "$SECONDS" "$1"; }
quietly() { "$@" > "$work/said.log" 2>&1 || { local s=$?; cat "$work/said.log"; fail "status $s of $*"; }; }

[ -n "${NONIO_TEST_PACKAGES:-}" ] || skip "it takes minutes and makes a whole Debian; NONIO_TEST_PACKAGES=1 asks for it"
[ "$(id -u)" = 0 ] || skip "it makes a root file system, which needs root"
for program in buildah mmdebstrap man mkdocs; do
  [ -n "$(type -P $program)" ] || skip "$program is missing (scripts/install-dependencies --all)"
done
unshare --mount --pid --fork true 2> /dev/null || skip "unshare --mount is not permitted here"
/usr/lib/apt/apt-helper download-file http://deb.debian.org/debian/dists/bookworm/Release "$work/Release" > /dev/null 2>&1 ||
  skip "no way to deb.debian.org"

# Runs a command in a copy of Debian; mounts and processes end with it.
in_root() { # ROOT COMMAND...
  # shellcheck disable=SC2016 # its own $0 and $@
  unshare --mount --pid --fork bash -euc 'mount -t proc proc "$0/proc"; mount --rbind /dev "$0/dev"
    mkdir -p "$0/var/cache/apt/archives"; mount --bind "$ARCHIVES" "$0/var/cache/apt/archives"
    exec chroot "$0" "$@"' "$@"
}
export ARCHIVES=$store/archives DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 PATH="$PATH:/usr/sbin:/sbin"
export -n CXX CC CMAKE_GENERATOR NONIO_PLUGIN_PATH 2> /dev/null || true
mkdir -p "$ARCHIVES/partial"

quietly cmake --build "$build" --target docs_site  # each link of its pages leads to a page, or this fails
cp "$build/CPackConfig.cmake" "$work/"
quietly "$cpack" --config "$build/CPackConfig.cmake" -B "$work/packages"
package=$(echo "$work"/packages/nonio_*.deb) development=$(echo "$work"/packages/libnonio-dev_*.deb)
step "packed: $(basename "$package") ($(($(stat -c %s "$package") / 1000)) kB), $(basename "$development")"
dpkg-deb -c "$package" | grep -q 'doc/nonio/site/index\.html' || fail "the pages of the documentation are not in the package"
if [ -n "$(type -P lintian)" ]; then
  lintian --allow-root --fail-on error,warning --tag-display-limit 0 "$work"/packages/*.deb || fail "lintian found errors or warnings"
  step "lintian: $(basename -a "$work"/packages/*.deb | tr '\n' ' ')"
else
  step "lintian is missing (scripts/install-dependencies --all): the packages were not checked with it"
fi

# The image of the Containerfile. A fresh Debian replaces the base image that an engine would fetch.
base=docker.io/library/debian:bookworm-slim
images() { buildah --root "$store/images" --runroot "$work/images" --storage-driver vfs "$@"; }
images inspect --type image $base > /dev/null 2>&1 || {
  quietly mmdebstrap --variant=minbase --format=tar bookworm "$work/bookworm.tar"
  fresh=$(images from scratch)
  quietly images add "$fresh" "$work/bookworm.tar" /
  quietly images commit --rm --disable-compression "$fresh" $base
  rm "$work/bookworm.tar"
}
fresh=$(images from --pull-never $base)
files() { # ROOT: what is in it, but for what apt, dpkg and adduser write of themselves, and names of hosts
  (cd "$1" && find . -xdev \( -path ./var/cache -o -path ./var/lib/apt -o -path ./var/lib/dpkg -o -path ./var/log -o -path ./tmp \
    -o -path ./run -o -path './etc/*-' -o -path ./etc/hosts -o -path ./etc/resolv.conf \) -prune -o -printf '%p %y\n' | sort
    cut -d: -f1 etc/passwd etc/group)
}
files "$(images mount "$fresh")" > "$work/files-before"
images rm "$fresh" > /dev/null
step "a fresh Debian"
quietly images bud --isolation chroot --pull-never --disable-compression -t nonio -f "$source/cmake/package/Containerfile" "$work/packages"
container=$(images from --pull-never localhost/nonio)
root=$(images mount "$container")
trap 'images rm "$container" > /dev/null; images rmi --force nonio > /dev/null; rm -rf --one-file-system "$work"' EXIT
[ -z "$(find "$root/tmp" "$root/var/lib/apt/lists" -type f)" ] || fail "the image has files that nobody needs"
user=$(images inspect --type image --format '{{.OCIv1.Config.User}}' nonio)
starts=$(images inspect --type image --format '{{.OCIv1.Config.Entrypoint}} {{.OCIv1.Config.Cmd}}' nonio)
[ "$user $starts" = 'nonio [/usr/bin/nonio] [--help]' ] || fail "the image starts \"$starts\" as \"$user\""
images run --isolation chroot "$container" -- nonio --help > "$work/help" || fail "nonio does not start in the image"
grep -q '^  run ' "$work/help" || fail "the image's help does not say what it does"
echo force-unsafe-io > "$root/etc/dpkg/dpkg.cfg.d/test"
echo 'APT::Keep-Downloaded-Packages "true";' > "$root/etc/apt/apt.conf.d/test"
cp /etc/resolv.conf "$root/etc/"
step "the Containerfile's image, and nonio --help in it"

# A run over the samples has the same bytes as one of the build tree.
as_user() { in_root "$root" setpriv --reuid nonio --regid nonio --clear-groups "$@"; }
status() { local s=0; "$@" >&2 || s=$?; echo $s; }
examples=/usr/share/doc/nonio/examples
install -d -o "$(stat -c %u "$source")" "$work/ours"
[ "$(status "$build/bin/nonio" run "$source/samples/site" --out "$work/ours" --quiet 2> "$work/ours.log")" = 1 ] || fail "the build's night"
in_root "$root" install -d -o nonio -g nonio /srv/nonio/out
[ "$(status as_user nonio run $examples/site --out /srv/nonio/out --quiet 2> "$work/theirs.log")" = 1 ] ||
  { cat "$work/theirs.log"; fail "the package's night"; }
diff "$work/ours.log" "$work/theirs.log" || fail "the package's night says something else"
# run.json has the digests of the plugins, and those of the package are stripped.
diff -r --exclude=run.json --exclude=.nonio "$work/ours" "$root/srv/nonio/out" || fail "the package's night has other bytes"
[ "$(find "$root/srv/nonio/out" -name report.pdf | wc -l)" -ge 15 ] || fail "too few reports"
step "a night: $(find "$root/srv/nonio/out" -type f | wc -l) files, the same bytes as from the build tree"

# The files of the package other than the program.
for file in howto-plugin.md pictures/long-tables.svg plugins/readers/long-table/README.md examples/site/02-constant-reversal/campaign.toml; do
  [ -s "$root/usr/share/doc/nonio/$file" ] || fail "the package lacks /usr/share/doc/nonio/$file"
done
man --warnings -l "$root/usr/share/man/man1/nonio.1.gz" > "$work/man" 2> "$work/man.log"
[ ! -s "$work/man.log" ] || { cat "$work/man.log"; fail "the man page"; }
grep -q 'run SITE' "$work/man" || fail "the man page does not say what nonio run does"
# shellcheck disable=SC2016 # a script of its own
offers=$(in_root "$root" bash -euc 'source /usr/share/bash-completion/completions/nonio
  COMP_WORDS=(nonio ru) COMP_CWORD=1 COMP_LINE="nonio ru" COMP_POINT=8; set +eu
  eval "$(complete -p nonio | sed "s/.*-F \([^ ]*\).*/\1/") nonio ru nonio"; echo "${COMPREPLY[*]}"')
[ "${offers% }" = run ] || fail "completion of \"nonio ru\": expected \"run\", found \"$offers\""
if [ -n "$(type -P zsh)" ]; then zsh -n "$root/usr/share/zsh/vendor-completions/_nonio"
else echo "         zsh is missing: its completion is not read"; fi
[ -z "$(find "$root/etc/systemd" -name 'nonio*')" ] || fail "the timer is enabled by installing"
step "man page, completion"

# A plugin of one's own: first without the package for it, then with it.
[ "$(status in_root "$root" nonio plugin new controller x 2> "$work/refused")" = 2 ] || fail "plugin new without libnonio-dev"
grep -q libnonio-dev "$work/refused" || { cat "$work/refused"; fail "plugin new does not say what is missing"; }
cp "$package" "$development" "$root/tmp/"
quietly in_root "$root" sh -ec 'apt-get update; apt-get install -y --no-install-recommends /tmp/libnonio-dev_*.deb'
cp -a "$root" "$work/workshop"  # the compiler stays out of the root that is purged
quietly in_root "$work/workshop" apt-get install -y --no-install-recommends g++ cmake make systemd
step "libnonio-dev, a compiler, systemd"
# shellcheck disable=SC2016 # a script of its own
quietly in_root "$work/workshop" sh -euc 'cd /tmp; nonio plugin new controller x; cmake -S x -B x/build
  cmake --build x/build; ctest --test-dir x/build --output-on-failure'
grep -q '100% tests passed' "$work/said.log" || fail "no test of the plugin ran"
step "nonio plugin new controller, built and tested"

# The service with all that it is not allowed, under a systemd of its own.
units=(/usr/lib/systemd/system/nonio.service /usr/lib/systemd/system/nonio.timer /usr/lib/systemd/system/nonio-serve.service)
quietly in_root "$work/workshop" systemd-analyze verify --man=no "${units[@]}"
[ ! -s "$work/said.log" ] || { cat "$work/said.log"; fail "systemd-analyze verify"; }
quietly in_root "$work/workshop" systemd-analyze security --offline=true --threshold=20 --no-pager "${units[2]}"
quietly in_root "$work/workshop" systemd-analyze security --offline=true --threshold=20 --no-pager "${units[0]}"
exposed=$(grep -o 'level for.*' "$work/said.log" | grep -o '[0-9]\.[0-9]')
in_root "$work/workshop" sh -euc "cp -r $examples/site /srv/nonio/site; rm -r /srv/nonio/out; install -d -o nonio /srv/nonio/out"
booted=$(status "$here/booted.sh" "$work/workshop" sh -euc 'systemctl enable -q --now nonio.timer
  systemctl start nonio.service; systemctl show -p Result,ExecMainStatus nonio.service nonio.timer
  systemctl show -p NextElapseUSecRealtime nonio.timer; journalctl -u nonio -p warning --no-pager' \
  2> "$work/service")
if [ "$booted" = 77 ]; then echo "         systemd does not start here: the service was not run"
else
  for words in Result=success ExecMainStatus=1 'failed .*08-broken-file.*x.csv:17' 'NextElapse.* 22:15:00'; do
    grep -q "$words" "$work/service" || { cat "$work/service"; fail "nonio.service: expected \"$words\""; }
  done
  diff -r --exclude=run.json --exclude=.nonio "$work/ours" "$work/workshop/srv/nonio/out" || fail "the service's night has other bytes"
  step "nonio.service, the same bytes (exposure $exposed); nonio.timer"
fi

# Purge leaves what a user made, and nothing else.
quietly systemctl --root="$root" enable nonio.timer
cp "$root/var/lib/dpkg/info/nonio.postrm" "$root/tmp/postrm"
quietly in_root "$root" apt-get purge -y libnonio-dev nonio
[ -s "$root/srv/nonio/out/summary.txt" ] || fail "purge took the results"
grep -q 'both stay' "$work/said.log" || fail "purge does not say that the user stays"
grep -q '^nonio:' "$root/etc/passwd" || fail "purge took the user whose results stay"
rm -r "$root/srv/nonio"
quietly in_root "$root" sh -ec 'sh /tmp/postrm purge; apt-get autoremove -y --purge'
rm "$root/etc/dpkg/dpkg.cfg.d/test" "$root/etc/apt/apt.conf.d/test"
files "$root" > "$work/files-after"
diff "$work/files-before" "$work/files-after" || fail "purge left that (>) or took that (<)"
step "purged"
