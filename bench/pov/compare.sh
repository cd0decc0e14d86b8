#!/bin/sh
# SPDX-License-Identifier: MIT OR Apache-2.0
# Holds Dioptric's pictures of the Standard Procedural Databases in NFF against POV-Ray's of their twins, pixel by
# pixel without anti-aliasing, and prints how far they are apart and how long each took.
#
#   bench/pov/compare.sh [DATA [OUT]]
#
# DATA is the folder with balls.nff, balls.pov, ... ; OUT keeps the pictures (without it they are thrown away).
# DIOPTRIC names the program, SIZE the side of the pictures in pixels, THREADS their number for both programs.
#
# The .pov files say some things that their .nff twins cannot say or that Dioptric means otherwise (see
# docs/manual/src/nff.md). Therefore each scene is rendered by POV-Ray twice: as it was published, and with these
# taken away by `level` (level.sh).
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
. "$root/bench/pov/level.sh"
data=$(cd "${1:-$root/../shared/data/spd}" && pwd)
dioptric=${DIOPTRIC:-$root/target/release/dioptric}
size=${SIZE:-512}
threads=${THREADS:-2}

need_povray compare.sh
[ -x "$dioptric" ] || (cd "$root" && cargo build --release)

if [ $# -ge 2 ]; then
    mkdir -p "$2"
    out=$(cd "$2" && pwd)
else
    out=$(mktemp -d)
    trap 'rm -rf "$out"' EXIT
fi

# POV-Ray's picture, as computed: files that name no gamma get none, and 16 bits keep the numbers.
pov() {
    povray "+I$1" "+O$2" "+W$size" "+H$size" -A -D +FN16 "+WT$threads" > "$3" 2>&1 ||
        { cat "$3" >&2; exit 1; }
}

# PSNR, largest difference and pixels beyond 2/255, as columns of the table.
apart() {
    "$dioptric" compare "$1" "$2" --tolerance 2/255 --json > "$3" || [ $? = 1 ]
    printf '%.2f dB | %.3f | %.2f %%' "$(number psnr "$3")" "$(number max_difference "$3")" \
        "$(awk "BEGIN { print 100 * $(number share_above "$3") }")"
}

echo "POV-Ray's trace time and Dioptric's render time are wall clock, $threads threads, $size x $size, one ray a pixel."
echo
echo "| scene | as published: PSNR | largest | beyond 2/255 | without the differences of model: PSNR | largest | beyond 2/255 | POV-Ray: parse, bound | trace | Dioptric: read, compile | render |"
echo "|---|---|---|---|---|---|---|---|---|---|---|"
for scene in balls gears rings teapot tree; do
    here=$out/$scene
    mkdir -p "$here"
    level "$data/$scene" > "$here/level.pov"
    pov "$data/$scene.pov" "$here/POV-Ray.png" "$here/pov.log"
    pov "$here/level.pov" "$here/level.png" "$here/level.log"
    "$dioptric" render "$data/$scene.nff" --size "${size}x$size" --antialias none --bits 16 --threads "$threads" \
        --quiet --output "$here/Dioptric.png" --stats "$here/stats.json"
    printf '| %s | %s | %s | %s s, %s s | %s s | %.3f s, %.3f s | %.3f s |\n' "$scene" \
        "$(apart "$here/POV-Ray.png" "$here/Dioptric.png" "$here/published.json")" \
        "$(apart "$here/level.png" "$here/Dioptric.png" "$here/level.json")" \
        "$(seconds Parse "$here/pov.log")" "$(seconds Bounding "$here/pov.log")" "$(seconds Trace "$here/pov.log")" \
        "$(number read "$here/stats.json")" "$(number compile "$here/stats.json")" "$(number render "$here/stats.json")"
done
