#!/bin/sh
# SPDX-License-Identifier: MIT OR Apache-2.0
# Times scenes/space.star: the first picture from a cold start, beside a program that does nothing, and the whole picture
# on one and on two threads.
#
#   bench/space/run.sh
#
# DIOPTRIC names the program, or several to compare, in turn; STARTS says how often the first picture is made (41), ROUNDS
# how often the whole (5). Takes about a minute.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
programs=${DIOPTRIC:-$root/target/release/dioptric}
starts=${STARTS:-41} rounds=${ROUNDS:-5}
[ -n "${DIOPTRIC:-}" ] || [ -x "$programs" ] || (cd "$root" && cargo build --release)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Microseconds of wall clock that "$@" takes.
clock() {
    start=$(date +%s%N)
    "$@" > /dev/null
    echo $((($(date +%s%N) - start) / 1000))
}
# Median, least and most of the numbers in a file.
spread() { sort -n "$1" | awk '{ v[NR] = $1 } END { printf "%.*f (%.*f to %.*f)", d, v[int((NR + 1) / 2)] / u, d, v[1] / u, d, v[NR] / u }' "d=$2" "u=$3"; }
number() { tr ',{}' '\n\n\n' < "$2" | sed -n "s/^ *\"$1\": *//p"; }
scene=$root/scenes/space.star

i=0
while [ $i -lt "$starts" ]; do
    i=$((i + 1))
    clock /bin/true >> "$work/nothing"
    n=0
    for program in $programs; do
        n=$((n + 1))
        clock "$program" render "$scene" --size 64x64 --quiet --output "$work/first.png" >> "$work/first.$n"
    done
done
echo "| milliseconds, medians (least to most) of $starts in turn | |"
echo "|---|---|"
echo "| \`/bin/true\` | $(spread "$work/nothing" 1 1000) |"
n=0
for program in $programs; do
    n=$((n + 1))
    echo "| \`$(basename "$program") render scenes/space.star --size 64x64\` | $(spread "$work/first.$n" 1 1000) |"
done

i=0
while [ $i -lt "$rounds" ]; do
    i=$((i + 1))
    for threads in 1 2; do
        n=0
        for program in $programs; do
            n=$((n + 1))
            "$program" render "$scene" --threads $threads --quiet --output "$work/whole.png" --stats "$work/stats.json"
            number render "$work/stats.json" >> "$work/whole.$n.$threads"
            number total "$work/stats.json" > "$work/rays.$n"
        done
    done
done
echo
echo "| \`render scenes/space.star\`, 800 x 800, 4 samples | threads | render seconds | million rays a second a thread |"
echo "|---|---|---|---|"
n=0
for program in $programs; do
    n=$((n + 1))
    for threads in 1 2; do
        seconds=$(spread "$work/whole.$n.$threads" 3 1)
        echo "| $(basename "$program"), $(cat "$work/rays.$n") rays | $threads | $seconds |" \
            "$(awk "BEGIN { printf \"%.2f\", $(cat "$work/rays.$n") / ${seconds%% *} / $threads / 1e6 }") |"
    done
done
