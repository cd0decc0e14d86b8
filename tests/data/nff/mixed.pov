// mixed.nff, by the rules of docs/manual/src/nff.md, for POV-Ray.
background { color red 0.078 green 0.361 blue 0.753 }

// The direction has length 1, right and up 2 tan(36 deg / 2).
#declare Away = vnormalize(<0, 0, 0.7> - <3.5, -5, 3>);
#declare Right = vnormalize(vcross(Away, <0, 0, 1>));
#declare Width = 2 * tan(radians(18));
camera {
    location <3.5, -5, 3>
    direction Away
    right Width * Right
    up Width * vcross(Right, Away)
}

light_source { <5, -6, 8> color red 0.707106781 green 0.707106781 blue 0.707106781 }
light_source { <-6, -3, 6> color red 0.707106781 green 0.707106781 blue 0.707106781 }

#declare Ground = texture {
    pigment { color red 1 green 0.75 blue 0.33 }
    finish { ambient 0 diffuse 0.8 }
}
triangle { <4, 4, 0>, <-4, 4, 0>, <-4, -4, 0> texture { Ground } }
triangle { <4, 4, 0>, <-4, -4, 0>, <4, -4, 0> texture { Ground } }

#declare Gold = texture {
    pigment { color red 1 green 0.9 blue 0.7 }
    finish { ambient 0 diffuse 0.5 phong 0.4 phong_size 6 reflection 0.4 }
}
sphere { <0.2, 0.6, 0.8>, 0.8 texture { Gold } }
cylinder { <-1.2, 0.4, 0>, <-1.2, 0.4, 1.3>, 0.25 open texture { Gold } }

#declare Blue = texture {
    pigment { color red 0.3 green 0.5 blue 1 }
    finish { ambient 0 diffuse 0.6 phong 0.2 phong_size 20 reflection 0.2 }
}
cone { <1.4, 0.5, 0>, 0.4, <1.4, 0.5, 1.2>, 0.1 open texture { Blue } }
cone { <-0.4, -0.9, 0>, 0.3, <-0.4, -0.9, 0.5>, 0.15 open texture { Blue } }

#declare RedPane = texture {
    pigment { color red 1 green 0.4 blue 0.4 filter 0.8 }
    finish { ambient 0 diffuse 0.5 }
}
triangle { <0.3, -1.2, 0>, <1.3, -0.7, 0>, <1.3, -0.7, 1.1> texture { RedPane } }
triangle { <0.3, -1.2, 0>, <1.3, -0.7, 1.1>, <0.3, -1.2, 1.1> texture { RedPane } }
#declare GreenPane = texture {
    pigment { color red 0.5 green 1 blue 0.5 filter 0.6 }
    finish { ambient 0 diffuse 0.5 }
}
triangle { <-1.5, -0.6, 1.2>, <-0.7, -1.2, 1.2>, <-0.7, -1.2, 0.1> texture { GreenPane } }
triangle { <-1.5, -0.6, 1.2>, <-0.7, -1.2, 0.1>, <-1.5, -0.6, 0.1> texture { GreenPane } }

#declare Letter = texture {
    pigment { color red 0.2 green 0.2 blue 0.6 }
    finish { ambient 0 diffuse 1 }
}
triangle { <1.2, -1.6, 0.01>, <2.2, -1.6, 0.01>, <2.2, -1.3, 0.01> texture { Letter } }
triangle { <1.2, -1.6, 0.01>, <2.2, -1.3, 0.01>, <1.2, -1.3, 0.01> texture { Letter } }
triangle { <1.9, -1.3, 0.01>, <2.2, -1.3, 0.01>, <2.2, -0.6, 0.01> texture { Letter } }
triangle { <1.9, -1.3, 0.01>, <2.2, -0.6, 0.01>, <1.9, -0.6, 0.01> texture { Letter } }

#declare Leaf = texture {
    pigment { color red 0.4 green 0.9 blue 0.4 }
    finish { ambient 0 diffuse 0.7 phong 0.2 phong_size 12 reflection 0.2 }
}
smooth_triangle {
    <-0.4, -2.2, 0>, <-0.5, -0.6, 0.6>, <0.5, -2.2, 0>, <0.5, -0.6, 0.6>,
    <0.5, -1.7, 0.4>, <0.5, -0.2, 0.9> texture { Leaf }
}
smooth_triangle {
    <-0.4, -2.2, 0>, <-0.5, -0.6, 0.6>, <0.5, -1.7, 0.4>, <0.5, -0.2, 0.9>,
    <-0.4, -1.7, 0.4>, <-0.5, -0.2, 0.9> texture { Leaf }
}
