#!/bin/sh
# deploy/docker/base-image.sh [NAME]
# Makes the Debian 12 image that deploy/docker/Dockerfile starts from, as NAME (default:
# debian:bookworm-slim, as a registry calls it), on a site without a registry. Packages come from
# this machine's own apt sources, which the image is given as well, with the proxy and other settings
# for their download. Needs root and debootstrap.
set -eu

name=${1:-debian:bookworm-slim}

fail() {
  echo "base-image: $1" >&2
  exit "${2:-1}"
}
case $name in -*) fail "usage: deploy/docker/base-image.sh [NAME]" 2 ;; esac
[ "$(id -u)" = 0 ] || fail "must be run by root (debootstrap)" 2
for program in apt-get debootstrap docker; do
  command -v "$program" >/dev/null || fail "needs $program" 2
done
docker info >/dev/null 2>&1 || fail "no Docker daemon answers" 2

# One line a source: address, release, component.
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP
# shellcheck disable=SC2016  # the format is apt's
apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
  awk '$2 ~ /^bookworm(-updates|-security)?$/ && $3 == "main" && !seen[$0]++' >"$scratch/sources"
mirror=$(awk '$2 == "bookworm" {print $1; exit}' "$scratch/sources")
[ -n "$mirror" ] || fail "this machine's apt has no source for Debian 12 (bookworm, main)" 2
certificates=$(awk '$1 ~ /^https:/ {print "--include=ca-certificates"; exit}' "$scratch/sources")

echo "base-image: debootstrap of Debian 12"
root=$scratch/root
# shellcheck disable=SC2086  # an option or none
debootstrap --variant=minbase $certificates bookworm "$root" "$mirror" >"$scratch/log" 2>&1 || {
  tail -n 20 "$scratch/log" >&2
  fail "debootstrap failed"
}
sed 's/^/deb /' "$scratch/sources" >"$root/etc/apt/sources.list"
apt-config dump | grep -E '^Acquire::(https?::|Check-|Retries)' \
  >"$root/etc/apt/apt.conf.d/90as-on-the-host" || true
rm -rf "$root"/var/cache/apt/archives/*.deb "$root"/var/lib/apt/lists/* "$root"/var/log/*.log
tar -C "$root" --numeric-owner -cf "$scratch/root.tar" .  # whole, before it gets its name
docker import -c 'CMD ["bash"]' "$scratch/root.tar" "$name" >/dev/null
echo "base-image: $(docker image inspect -f '{{.Size}}' "$name" | awk '{printf "%.0f", $1 / 1e6}') MB: $name"
