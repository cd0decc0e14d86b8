// SPDX-License-Identifier: MIT OR Apache-2.0
// Embree as this benchmark uses it: medium quality, not robust, one geometry.
#pragma once

#include <embree3/rtcore.h>
#include <limits>

#include "files.hpp"

struct Tracer {
    RTCDevice device;
    RTCScene scene;

    /// Hands the scene over and builds with so many threads; without triangles or spheres nothing is hit.
    Tracer(const Scene& data, int threads) {
        device = rtcNewDevice(("threads=" + std::to_string(threads)).c_str());
        if (!device) fail("Embree does not start");
        scene = rtcNewScene(device);
        rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_NONE);
        const bool spheres = !data.spheres.empty();
        RTCGeometry shape =
            rtcNewGeometry(device, spheres ? RTC_GEOMETRY_TYPE_SPHERE_POINT : RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuildQuality(shape, RTC_BUILD_QUALITY_MEDIUM);
        const auto fill = [&](RTCBufferType type, RTCFormat format, size_t stride, size_t count, const void* from) {
            memcpy(rtcSetNewGeometryBuffer(shape, type, 0, format, stride, count), from, stride * count);
        };
        if (spheres) {
            fill(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sizeof(Sphere), data.spheres.size(), data.spheres.data());
        } else {
            fill(RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(Vec), data.vertices.size(), data.vertices.data());
            fill(RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT3, 12, data.indices.size() / 3, data.indices.data());
        }
        rtcCommitGeometry(shape);
        rtcAttachGeometry(scene, shape);
        rtcReleaseGeometry(shape);
    }

    void build() { rtcCommitScene(scene); }

    ~Tracer() {
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    }
};

inline RTCRay ray_of(const Ray& ray) {
    RTCRay r;
    r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
    r.tnear = 0, r.tfar = std::numeric_limits<float>::infinity();
    r.time = 0, r.mask = ~0u, r.id = 0, r.flags = 0;
    return r;
}
