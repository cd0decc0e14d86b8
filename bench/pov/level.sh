# SPDX-License-Identifier: MIT OR Apache-2.0
# What the scripts of this folder share; they read it with `.`, it is no program.

# The .pov without what the .nff does not have: ambient light of the floor of balls, highlights of another strength
# than the mirror, the bending of rays by the polygons of gears, and a camera whose vectors are rounded to six digits.
level() {
    view=$(awk '$1 == "from" || $1 == "at" || $1 == "up" { v[$1] = "<" $2 "," $3 "," $4 ">" } $1 == "angle" { a = $2 }
        END { away = "vnormalize(" v["at"] "-" v["from"] ")"
              right = "vnormalize(vcross(" away "," v["up"] "))"
              width = "2*tan(radians(" a "/2))"
              print "camera { location " v["from"] " direction " away " right " width "*" right \
                  " up " width "*vcross(" right "," away ") }" }' "$1.nff")
    echo "$view"
    sed -e '/^camera {/,/^}/d' -e 's/ambient 0\.2/ambient 0/' -e 's/refraction 1\.0 ior 1\.1//' \
        -e '/phong /{N;s/phong [0-9.]*\(  phong_size [0-9.]*\n *reflection \)\([0-9.]*\)/phong \2\1\2/;}' "$1.pov"
}

# Installs POV-Ray where that is possible.
need_povray() {
    command -v povray > /dev/null && return
    if [ "$(id -u)" != 0 ] || ! command -v apt-get > /dev/null; then
        echo "$1: POV-Ray is not here; on Debian: apt-get install povray" >&2
        exit 1
    fi
    apt-get install -y povray > /dev/null
}

# Seconds that a line of POV-Ray's report ends with.
seconds() { sed -n "s/.*$1 Time:.*(\([0-9.]*\) seconds).*/\1/p" "$2"; }

# A number of a JSON file.
number() { tr ',{}' '\n\n\n' < "$2" | sed -n "s/^ *\"$1\": *//p"; }
