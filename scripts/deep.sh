#!/usr/bin/env bash
# Runs the deep checks: those that take minutes each, of which .ci/run takes one per submission in rotation.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

usage() {
    cat <<'TEXT'
usage: scripts/deep.sh [--again] [CHECK...]
       scripts/deep.sh --list | --turn

Runs the named checks (default: all of them), one after the other, and prints a table at the end. A failed
check does not stop the others; the exit status is 1 if one has failed. Logs are in build/deep.

A check that passed for the same files before is not run again: its stamp, the hash of these files, is kept in
~/.cache/palpate/passed. Changes that are not committed leave no stamp.

  --again  run a check even if it has passed for the same files
  --list   print each check and what it does
  --turn   print the check whose turn it is: the number of commits modulo the number of checks

The checks are the programs in scripts/deep. The line "# inputs:" of each names the files that decide its result.
TEXT
}

# In the order of the rotation: cheap and expensive ones take turns.
checks=(alone tsan golden readme analyse asan fuzz packages container adversary windows web)
stamps=${XDG_CACHE_HOME:-$HOME/.cache}/palpate/passed

# stamp_of CHECK: where its stamp is; nothing if a file that decides its result has changed since the last commit.
stamp_of() {
    local inputs
    read -ra inputs < <(sed -n 's/^# inputs: //p' "scripts/deep/$1")
    inputs+=("scripts/deep/$1")
    [ -z "$(git status --porcelain -- "${inputs[@]}")" ] || return 0
    echo "$stamps/$1-$(git ls-tree -r HEAD -- "${inputs[@]}" | git hash-object --stdin)"
}

again=no
wanted=()
for argument in "$@"; do
    case "$argument" in
        -h | --help) usage; exit 0 ;;
        --again) again=yes ;;
        --list) for check in "${checks[@]}"; do printf '%-10s %s\n' "$check" "$(grep -m 1 -oP '^# (?!inputs:)\K.*' "scripts/deep/$check")"; done; exit 0 ;;
        --turn) echo "${checks[$(($(git rev-list --count HEAD) % ${#checks[@]}))]}"; exit 0 ;;
        *)
            if [[ " ${checks[*]} " != *" $argument "* ]]; then
                echo "deep.sh: no check '$argument'; the checks are ${checks[*]}" >&2
                exit 2
            fi
            wanted+=("$argument")
            ;;
    esac
done
[ ${#wanted[@]} -gt 0 ] || wanted=("${checks[@]}")

mkdir -p build/deep "$stamps"
# With a sanitizer a failed case is run once more (tests/second_chance.py); those that pass then are listed.
export PALPATE_PASSED_AGAIN=${PALPATE_PASSED_AGAIN:-$PWD/build/deep/passed_again}
rm -f build/deep/passed_again
table=()
status=0
for check in "${wanted[@]}"; do
    stamp=$(stamp_of "$check")
    start=$SECONDS
    if [ "$again" = no ] && [ -n "$stamp" ] && [ -e "$stamp" ]; then
        result="passed before ($(cat "$stamp"))"
    else
        echo "deep: ==== $check"
        if "scripts/deep/$check" 2>&1 | tee "build/deep/$check.log"; then
            result=passed
            # Of the files that were checked; none if they have changed meanwhile.
            if [ -n "$stamp" ] && [ "$stamp" = "$(stamp_of "$check")" ]; then git log -1 --format=%h >"$stamp"; fi
        else
            result=FAILED
            status=1
        fi
    fi
    table+=("$(printf '%-10s %5d s  %s' "$check" $((SECONDS - start)) "$result")")
done
echo "deep: done"
printf '%s\n' "${table[@]}"
if [ -e build/deep/passed_again ]; then sed 's/^/deep: passed only when run again: /' build/deep/passed_again; fi
exit "$status"
