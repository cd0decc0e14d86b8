// SPDX-License-Identifier: MIT OR Apache-2.0
// Embree on the same files as `dioptric trace`:
//
//   embree trace SCENE.ply RAYS THREADS REPEAT closest|any|packet OUT
//       builds, casts all rays REPEAT times after once to warm up, writes one f32 a ray (the distance or infinity; with
//       `any` 1 or 0), prints `build N.NNN s` and `median N.NN Mrays/s (min .. max)`
//   embree compare SCENE.ply RAYS closest|any OURS THEIRS
//       prints how many rays there are, how many differ, for how many of those brute force in double precision agrees
//       with OURS and with THEIRS, and how many of each hit nothing
//   embree peak COMMAND ...
//       runs a command and prints the most memory that it had, in MiB, on standard error
//
// `closest` and `any` make one call of rtcIntersect1 or rtcOccluded1 for each ray, in the order of the file. `packet`
// makes one call of rtcIntersect16 for each sixteen rays of the file.

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <pmmintrin.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "tracer.hpp"

static const float INF = std::numeric_limits<float>::infinity();

static double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

static void closest(RTCScene scene, const Ray* rays, size_t count, float* out) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < count; i++) {
        RTCRayHit hit;
        hit.ray = ray_of(rays[i]);
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &hit);
        out[i] = hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INF : hit.ray.tfar;
    }
}

static void any(RTCScene scene, const Ray* rays, size_t count, float* out) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < count; i++) {
        RTCRay ray = ray_of(rays[i]);
        rtcOccluded1(scene, &context, &ray);
        out[i] = ray.tfar < 0 ? 1 : 0;
    }
}

static void packet(RTCScene scene, const Ray* rays, size_t count, float* out) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (size_t i = 0; i < count; i += 16) {
        RTCRayHit16 hit;
        alignas(64) int valid[16];
        for (size_t j = 0; j < 16; j++) {
            const Ray& ray = rays[std::min(i + j, count - 1)];
            valid[j] = i + j < count ? -1 : 0;
            hit.ray.org_x[j] = ray.origin.x, hit.ray.org_y[j] = ray.origin.y, hit.ray.org_z[j] = ray.origin.z;
            hit.ray.dir_x[j] = ray.direction.x, hit.ray.dir_y[j] = ray.direction.y, hit.ray.dir_z[j] = ray.direction.z;
            hit.ray.tnear[j] = 0, hit.ray.tfar[j] = INF, hit.ray.time[j] = 0;
            hit.ray.mask[j] = ~0u, hit.ray.id[j] = 0, hit.ray.flags[j] = 0;
            hit.hit.geomID[j] = RTC_INVALID_GEOMETRY_ID, hit.hit.instID[0][j] = RTC_INVALID_GEOMETRY_ID;
        }
        rtcIntersect16(valid, scene, &context, &hit);
        for (size_t j = 0; j < 16 && i + j < count; j++)
            out[i + j] = hit.hit.geomID[j] == RTC_INVALID_GEOMETRY_ID ? INF : hit.ray.tfar[j];
    }
}

static void trace(char** words) {
    const Scene data = read_ply(words[0]);
    const auto rays = read_array<Ray>(words[1]);
    const int threads = atoi(words[2]), repeat = atoi(words[3]);
    const std::string query = words[4];
    const auto cast = query == "closest" ? closest : query == "any" ? any : query == "packet" ? packet : nullptr;
    if (!cast || threads < 1 || repeat < 1) fail("THREADS and REPEAT from 1, then closest, any or packet");
    Tracer tracer(data, threads);
    const double start = now();
    tracer.build();
    printf("build %.3f s\n", now() - start);

    std::vector<float> out(rays.size());
    std::vector<double> speeds;
    for (int i = 0; i <= repeat; i++) {
        const double start = now();
        // Chunks as they come: no thread waits for another.
        const size_t chunk = 4096;
        std::atomic<size_t> next{0};
        const auto work = [&] {
            _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
            _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
            for (size_t at; (at = next.fetch_add(chunk)) < rays.size();)
                cast(tracer.scene, &rays[at], std::min(chunk, rays.size() - at), &out[at]);
        };
        std::vector<std::thread> others;
        for (int t = 1; t < threads; t++) others.emplace_back(work);
        work();
        for (auto& other : others) other.join();
        if (i > 0) speeds.push_back(double(rays.size()) / (now() - start) / 1e6);
    }
    std::sort(speeds.begin(), speeds.end());
    const double median = (speeds[speeds.size() / 2] + speeds[(speeds.size() - 1) / 2]) / 2;
    printf("median %.2f Mrays/s (%.2f .. %.2f)\n", median, speeds.front(), speeds.back());
    write_array(words[5], out);
}

/// The distance at which a ray meets a triangle (Moeller and Trumbore, "Fast, Minimum Storage Ray/Triangle
/// Intersection", 1997), or infinity.
static double meet(const Ray& ray, const Vec* corners[3]) {
    const double o[3] = {ray.origin.x, ray.origin.y, ray.origin.z};
    const double d[3] = {ray.direction.x, ray.direction.y, ray.direction.z};
    const auto at = [](const Vec& v, int k) { return double(k == 0 ? v.x : k == 1 ? v.y : v.z); };
    double e[3], f[3], s[3], p[3], q[3];
    for (int k = 0; k < 3; k++) {
        e[k] = at(*corners[1], k) - at(*corners[0], k), f[k] = at(*corners[2], k) - at(*corners[0], k);
        s[k] = o[k] - at(*corners[0], k);
    }
    const auto cross = [](const double* a, const double* b, double* out) {
        for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
    };
    const auto dot = [](const double* a, const double* b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; };
    cross(d, f, p), cross(s, e, q);
    const double det = dot(e, p), u = dot(s, p) / det, v = dot(d, q) / det, t = dot(f, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && t >= 0 ? t : INF;
}

static double meet(const Ray& ray, const Sphere& sphere) {
    const double x = sphere.x - double(ray.origin.x), y = sphere.y - double(ray.origin.y),
                 z = sphere.z - double(ray.origin.z), r = sphere.radius;
    const double dx = ray.direction.x, dy = ray.direction.y, dz = ray.direction.z;
    const double a = dx * dx + dy * dy + dz * dz, b = x * dx + y * dy + z * dz;
    const double root = b * b - a * (x * x + y * y + z * z - r * r);
    if (root < 0) return INF;
    const double near = (b - std::sqrt(root)) / a, far = (b + std::sqrt(root)) / a;
    return near >= 0 ? near : far >= 0 ? far : INF;
}

static double brute_force(const Scene& scene, const Ray& ray) {
    double least = INF;
    for (const Sphere& sphere : scene.spheres) least = std::min(least, meet(ray, sphere));
    for (size_t i = 0; i < scene.indices.size(); i += 3) {
        const Vec* corners[3];
        for (int k = 0; k < 3; k++) corners[k] = &scene.vertices[scene.indices[i + k]];
        least = std::min(least, meet(ray, corners));
    }
    return least;
}

/// Whether two distances agree: both infinite, or near to each other.
static bool same(double a, double b) {
    const double larger = std::max(std::abs(a), std::abs(b));
    return a == b || (larger < INF && std::abs(a - b) <= 1e-4 * larger);
}

static void compare(char** words) {
    const Scene scene = read_ply(words[0]);
    const auto rays = read_array<Ray>(words[1]);
    const bool closest = words[2] == std::string("closest");
    const float nothing = closest ? INF : 0;
    const auto ours = read_array<float>(words[3]), theirs = read_array<float>(words[4]);
    if (ours.size() != rays.size() || theirs.size() != rays.size()) fail("not as many hits as rays");
    size_t differ = 0, asked = 0, ours_right = 0, theirs_right = 0, ours_miss = 0, theirs_miss = 0;
    for (size_t i = 0; i < rays.size(); i++) {
        ours_miss += ours[i] == nothing, theirs_miss += theirs[i] == nothing;
        if (same(ours[i], theirs[i])) continue;
        differ++;
        if (asked == 200) continue; // enough to tell
        asked++;
        const double distance = brute_force(scene, rays[i]);
        const double right = closest ? distance : distance < INF;
        ours_right += same(ours[i], right), theirs_right += same(theirs[i], right);
    }
    printf("%zu rays, %zu differ (of %zu asked brute force agrees with %zu and %zu), %zu and %zu hit nothing\n",
           rays.size(), differ, asked, ours_right, theirs_right, ours_miss, theirs_miss);
}

static int peak(char** words) {
    const pid_t child = fork();
    if (child == 0) {
        execvp(words[0], words);
        fail(std::string(words[0]) + " cannot be run");
    }
    int status = 1;
    rusage usage{};
    wait4(child, &status, 0, &usage);
    fprintf(stderr, "peak %.0f MiB\n", double(usage.ru_maxrss) / 1024);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}

int main(int count, char** words) {
    const std::string what = count > 1 ? words[1] : "";
    if (what == "trace" && count == 8) trace(words + 2);
    else if (what == "compare" && count == 7) compare(words + 2);
    else if (what == "peak" && count > 2) return peak(words + 2);
    else fail("trace, compare or peak; see the head of embree.cpp");
}
