# shellcheck shell=bash
# A bare Debian 12 in a folder, for checks that need what a fresh machine has. Sourced by scripts in
# scripts/deep, with their arguments. It starts them again in a mount namespace of their own: what is mounted in
# the folder is seen by nothing else and disappears with them, however they end.

[ "$(id -u)" = 0 ] || exec sudo -- "$PWD/scripts/deep/${0##*/}" "$@"
[ -n "${PALPATE_OWN_MOUNTS:-}" ] || PALPATE_OWN_MOUNTS=yes exec unshare --mount "$PWD/scripts/deep/${0##*/}" "$@"

root=$PWD/build/deep/root
# Never reaches into what is mounted there: a bind mount may be on the same file system.
remove_root() {
    umount --recursive --lazy "$root" 2>/dev/null || true
    if grep -qF " $root" /proc/self/mountinfo; then
        echo "bare_root.sh: $root is still mounted; it stays" >&2
        return 1
    fi
    rm -rf --one-file-system "$root"
}
trap remove_root EXIT

# bare_system: debootstrap's smallest system, packed, at most 30 days old; from the mirror that apt uses here.
bare_system() {
    local mirror http_proxy="${http_proxy:-}"
    packed=${XDG_CACHE_HOME:-$HOME/.cache}/palpate/bookworm.tar
    [ -z "$(find "$packed" -mtime -30 2>/dev/null)" ] || return 0
    command -v debootstrap >/dev/null || { apt-get update && apt-get install -y --no-install-recommends debootstrap; } >/dev/null
    # shellcheck disable=SC2016  # apt expands it
    mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
        sed -n 's/ bookworm main$//p' | head -n 1)
    [ -n "$mirror" ] || { echo "bare_root.sh: apt has no source of Debian 12 (bookworm main)" >&2; return 1; }
    eval "$(apt-config shell http_proxy Acquire::http::Proxy)"
    echo "== debootstrap from $mirror"
    http_proxy=$http_proxy debootstrap --variant=minbase bookworm "$root" "$mirror" >"$root.log" 2>&1 ||
        { tail "$root.log" >&2; return 1; }
    mkdir -p "$(dirname "$packed")"
    tar -C "$root" -cf "$packed.part" .
    mv "$packed.part" "$packed"
    rm -rf --one-file-system "$root" "$root.log"
}

# bare_root: a bare Debian 12 in $root that reaches the mirrors which this machine reaches, and nothing else of it.
bare_root() {
    local packed name
    remove_root
    mkdir -p "$root"
    bare_system
    mkdir -p "$root"
    mount --bind "$root" "$root"
    tar -C "$root" -xf "$packed"
    chmod 755 "$root"  # apt reads its lists as another user
    rm -f "$root/etc/apt/sources.list"
    for name in sources.list sources.list.d auth.conf auth.conf.d trusted.gpg trusted.gpg.d keyrings; do
        if [ -e "/etc/apt/$name" ]; then cp -a "/etc/apt/$name" "$root/etc/apt/"; fi
    done
    apt-config dump Acquire | grep '^Acquire' >"$root/etc/apt/apt.conf.d/00as_outside"  # proxies, certificates
    cp /etc/hosts /etc/resolv.conf "$root/etc/"
    # Certificates for mirrors by https, which a bare system has none of.
    if grep -rqs https: /etc/apt/sources.list*; then cp -rL /etc/ssl/certs "$root/etc/ssl/"; fi
    mount -t proc proc "$root/proc"
    mount --rbind /sys "$root/sys"
    mount --rbind /dev "$root/dev"
    mount -t tmpfs -o mode=1777 tmpfs "$root/dev/shm"
    inside apt-get update -q >/dev/null
}

# inside [NAME=VALUE...] COMMAND...: runs it in the bare system, with nothing of this environment.
inside() {
    mkdir -p "$root/home/$(id -un)"
    chroot "$root" env -i PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin HOME=/home/"$(id -un)" "$@" </dev/null
}
