// SPDX-License-Identifier: MIT OR Apache-2.0
// Makes the scenes and rays of this benchmark, always the same:
//
//   generate closed|terrain|spheres COUNT SIDE OUT
//
// writes OUT.ply with about COUNT triangles or spheres, OUT-primary.rays with SIDE x SIDE rays of a pinhole camera in
// scanline order, and OUT-bounce.rays with one cosine-distributed ray from each of their hit points, in the same order.
// OUT.star is the scene of that camera, to be looked at. Compile without contraction of products and sums.

#include <cmath>
#include <unordered_map>

#include "tracer.hpp"

struct Double3 {
    double x, y, z;
    Double3 operator+(Double3 o) const { return {x + o.x, y + o.y, z + o.z}; }
    Double3 operator-(Double3 o) const { return {x - o.x, y - o.y, z - o.z}; }
    Double3 operator*(double s) const { return {x * s, y * s, z * s}; }
};
static double dot(Double3 a, Double3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static Double3 cross(Double3 a, Double3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static Double3 unit(Double3 a) { return a * (1 / std::sqrt(dot(a, a))); }
static Vec single(Double3 a) { return {float(a.x), float(a.y), float(a.z)}; }
static Double3 wide(Vec a) { return {a.x, a.y, a.z}; }

/// Mixes the bits of a number (Steele et al., "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014, mix64).
static uint64_t mix(uint64_t z) {
    z += 0x9e3779b97f4a7c15;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
}

/// Random numbers in 0 to 1.
struct Random {
    uint64_t state;
    double next() { return double(mix(state++) >> 11) / 9007199254740992.0; }
};

/// Value noise in -1 to 1: random numbers on the lattice, smoothly between.
static double noise(Double3 p) {
    const double fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
    const auto corner = [&](int i, int j, int k) {
        const uint64_t x = uint64_t(int64_t(fx) + i), y = uint64_t(int64_t(fy) + j), z = uint64_t(int64_t(fz) + k);
        return double(mix(mix(mix(x) ^ y) ^ z) >> 11) / 4503599627370496.0 - 1;
    };
    const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
    const double u = smooth(p.x - fx), v = smooth(p.y - fy), w = smooth(p.z - fz);
    const auto along = [&](int j, int k) { return corner(0, j, k) * (1 - u) + corner(1, j, k) * u; };
    const auto plane = [&](int k) { return along(0, k) * (1 - v) + along(1, k) * v; };
    return plane(0) * (1 - w) + plane(1) * w;
}

/// Noise with details of half the size and weight, and so on.
static double fractal(Double3 p, int octaves) {
    double sum = 0, weight = 1;
    for (int i = 0; i < octaves; i++) {
        sum += noise(p) * weight;
        p = p * 2.03 + Double3{17.3, 5.9, 11.1};
        weight *= 0.5;
    }
    return sum;
}

/// A ball with bumps: the surface of a cube of n x n squares a side, blown up; neighbours share their corners.
static Scene closed(size_t count) {
    const int n = std::max(1, int(std::sqrt(double(count) / 12) + 0.5));
    Scene scene;
    std::unordered_map<uint64_t, uint32_t> known;
    const auto vertex = [&](int i, int j, int k) {
        const uint64_t key = (uint64_t(i) * (n + 1) + j) * (n + 1) + k;
        const auto [at, fresh] = known.try_emplace(key, uint32_t(scene.vertices.size()));
        if (fresh) {
            const Double3 p = unit(Double3{double(i), double(j), double(k)} * (2.0 / n) - Double3{1, 1, 1});
            scene.vertices.push_back(single(p * (1 + 0.2 * fractal(p * 3, 5))));
        }
        return at->second;
    };
    for (int side = 0; side < 6; side++) {
        const int axis = side / 2, level = side % 2 * n;
        const auto corner = [&](int a, int b) {
            int at[3];
            at[axis] = level, at[(axis + 1) % 3] = a, at[(axis + 2) % 3] = b;
            return vertex(at[0], at[1], at[2]);
        };
        for (int a = 0; a < n; a++)
            for (int b = 0; b < n; b++) {
                uint32_t q[4] = {corner(a, b), corner(a + 1, b), corner(a + 1, b + 1), corner(a, b + 1)};
                if (level == 0) std::swap(q[1], q[3]); // outside is where the corners go around to the left
                for (int c : {0, 1, 2, 0, 2, 3}) scene.indices.push_back(q[c]);
            }
    }
    return scene;
}

/// A square of 2 x 2 with mountains.
static Scene terrain(size_t count) {
    const int n = std::max(1, int(std::sqrt(double(count) / 2) + 0.5));
    Scene scene;
    for (int j = 0; j <= n; j++)
        for (int i = 0; i <= n; i++) {
            const double x = 2.0 * i / n - 1, z = 2.0 * j / n - 1;
            scene.vertices.push_back(single({x, 0.25 * fractal({x * 3, 0.5, z * 3}, 7), z}));
        }
    for (uint32_t j = 0; j < uint32_t(n); j++)
        for (uint32_t i = 0; i < uint32_t(n); i++) {
            const uint32_t a = j * (n + 1) + i, b = a + n + 1;
            for (uint32_t c : {a, b, b + 1, a, b + 1, a + 1}) scene.indices.push_back(c);
        }
    return scene;
}

/// Balls of several sizes, anywhere in a cube, as near to each other as atoms: a ray meets one after ten or so.
static Scene spheres(size_t count) {
    Scene scene;
    Random random{1};
    const double size = 0.6 / std::cbrt(double(count));
    for (size_t i = 0; i < count; i++) {
        const double x = 2 * random.next() - 1, y = 2 * random.next() - 1, z = 2 * random.next() - 1;
        scene.spheres.push_back({float(x), float(y), float(z), float(size * (0.5 + random.next()))});
    }
    return scene;
}

static std::vector<Ray> primary(Double3 eye, Double3 at, double half_width, int side) {
    const Double3 forward = unit(at - eye), right = unit(cross(forward, {0, 1, 0})), up = cross(right, forward);
    std::vector<Ray> rays;
    for (int y = 0; y < side; y++)
        for (int x = 0; x < side; x++) {
            const double a = (2 * (x + 0.5) / side - 1) * half_width, b = (1 - 2 * (y + 0.5) / side) * half_width;
            rays.push_back({single(eye), single(unit(forward + right * a + up * b))});
        }
    return rays;
}

/// A ray from each point that is hit, leaving on the side that was hit, a little above the surface.
static std::vector<Ray> bounces(const Scene& scene, const std::vector<Ray>& rays) {
    Tracer tracer(scene, 2);
    tracer.build();
    std::vector<Ray> out;
    Random random{2};
    for (const Ray& ray : rays) {
        RTCRayHit hit;
        hit.ray = ray_of(ray);
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect1(tracer.scene, &context, &hit);
        // Taken from the sequence for misses too: a ray does not depend on what others meet.
        double x, y;
        do x = 2 * random.next() - 1, y = 2 * random.next() - 1;
        while (x * x + y * y >= 1);
        if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
        const Double3 d = wide(ray.direction);
        Double3 n = unit({hit.hit.Ng_x, hit.hit.Ng_y, hit.hit.Ng_z});
        if (dot(n, d) > 0) n = n * -1;
        const Double3 side = unit(std::abs(n.x) > 0.5 ? cross(n, {0, 1, 0}) : cross(n, {1, 0, 0}));
        // Malley's method: a point of the disc, lifted to the hemisphere above it.
        const Double3 away = side * x + cross(n, side) * y + n * std::sqrt(std::max(1e-6, 1 - x * x - y * y));
        const Double3 point = wide(ray.origin) + d * hit.ray.tfar + n * 1e-5;
        out.push_back({single(point), single(unit(away))});
    }
    return out;
}

struct View {
    Double3 eye, at;
    double half_width;
};

/// The scene as Dioptric reads it: the same shapes from the same place.
static void write_star(const std::string& out, const std::string& kind, const View& view) {
    const std::string name = out.substr(out.rfind('/') + 1);
    char text[1000];
    const auto& [eye, at, half_width] = view;
    const int size = snprintf(
        text, sizeof text,
        "version(1)\nrender(size = (512, 512))\nambient(0.2)\nlight(position = (%g, %g, %g), falloff = \"none\")\n"
        "camera(eye = (%g, %g, %g), look_at = (%g, %g, %g), fov = 2 * degrees(atan2(%g, 1)))\n%s(file = \"%s.ply\")\n",
        eye.x, eye.y + 0.1, eye.z, eye.x, eye.y, eye.z, at.x, at.y, at.z, half_width,
        kind == "spheres" ? "spheres" : "mesh", name.c_str());
    write_file(out + ".star", "", text, size_t(size));
}

int main(int count, char** words) {
    if (count != 5) fail("generate closed|terrain|spheres COUNT SIDE OUT");
    const std::string kind = words[1], out = words[4];
    const size_t number = strtoul(words[2], nullptr, 10);
    Scene scene;
    View view;
    if (kind == "closed") {
        scene = closed(number);
        view = {{0.1, 0.05, -0.2}, {1, 0.2, 0.4}, 1};
    } else if (kind == "terrain") {
        scene = terrain(number);
        view = {{-0.95, 0.55, -0.9}, {0, 0, 0}, 0.6};
    } else if (kind == "spheres") {
        scene = spheres(number);
        view = {{1.6, 1.1, 2.4}, {0, 0, 0}, 0.4};
    } else {
        fail("there is no scene " + kind + "; valid: closed, terrain, spheres");
    }
    const auto rays = primary(view.eye, view.at, view.half_width, atoi(words[3]));
    write_ply(out + ".ply", scene);
    write_star(out, kind, view);
    write_array(out + "-primary.rays", rays);
    write_array(out + "-bounce.rays", bounces(scene, rays));
}
