// SPDX-License-Identifier: MIT OR Apache-2.0
// The files of this benchmark: meshes and spheres as binary PLY, rays as six and hits as one little-endian f32.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

struct Vec {
    float x, y, z;
};

struct Sphere {
    float x, y, z, radius;
};

struct Ray {
    Vec origin, direction;
};

/// Triangles or spheres, one of both.
struct Scene {
    std::vector<Vec> vertices;
    std::vector<uint32_t> indices;
    std::vector<Sphere> spheres;
};

[[noreturn]] inline void fail(const std::string& what) {
    fprintf(stderr, "embree bench: %s\n", what.c_str());
    exit(1);
}

inline std::string read_file(const std::string& path) {
    FILE* file = fopen(path.c_str(), "rb");
    if (!file) fail("there is no file " + path);
    std::string bytes;
    fseek(file, 0, SEEK_END);
    bytes.resize(size_t(ftell(file)));
    rewind(file);
    if (fread(bytes.data(), 1, bytes.size(), file) != bytes.size()) fail(path + " cannot be read");
    fclose(file);
    return bytes;
}

template <class T> std::vector<T> read_array(const std::string& path) {
    const std::string bytes = read_file(path);
    std::vector<T> values(bytes.size() / sizeof(T));
    memcpy(values.data(), bytes.data(), values.size() * sizeof(T));
    return values;
}

inline void write_file(const std::string& path, const std::string& header, const void* data, size_t size) {
    FILE* file = fopen(path.c_str(), "wb");
    const bool done = file && fwrite(header.data(), 1, header.size(), file) == header.size() &&
                      fwrite(data, 1, size, file) == size && fclose(file) == 0;
    if (!done) fail(path + " cannot be written");
}

template <class T> void write_array(const std::string& path, const std::vector<T>& values) {
    write_file(path, "", values.data(), values.size() * sizeof(T));
}

#pragma pack(push, 1)
struct Face {
    uint8_t count;
    uint32_t corners[3];
};
#pragma pack(pop)

inline std::string header_of(const Scene& scene) {
    std::string text = "ply\nformat binary_little_endian 1.0\n";
    const size_t vertices = scene.spheres.empty() ? scene.vertices.size() : scene.spheres.size();
    text += "element vertex " + std::to_string(vertices) + "\n";
    text += "property float x\nproperty float y\nproperty float z\n";
    if (!scene.spheres.empty()) {
        text += "property float radius\n";
    } else {
        text += "element face " + std::to_string(scene.indices.size() / 3) + "\n";
        text += "property list uchar uint vertex_indices\n";
    }
    return text + "end_header\n";
}

inline void write_ply(const std::string& path, const Scene& scene) {
    std::string body;
    if (!scene.spheres.empty()) {
        body.assign(reinterpret_cast<const char*>(scene.spheres.data()), scene.spheres.size() * sizeof(Sphere));
    } else {
        std::vector<Face> faces(scene.indices.size() / 3);
        for (size_t i = 0; i < faces.size(); i++) {
            faces[i].count = 3;
            memcpy(faces[i].corners, &scene.indices[3 * i], sizeof faces[i].corners);
        }
        body.assign(reinterpret_cast<const char*>(scene.vertices.data()), scene.vertices.size() * sizeof(Vec));
        body.append(reinterpret_cast<const char*>(faces.data()), faces.size() * sizeof(Face));
    }
    write_file(path, header_of(scene), body.data(), body.size());
}

/// Reads the files that `write_ply` makes, and no others.
inline Scene read_ply(const std::string& path) {
    const std::string bytes = read_file(path);
    const size_t end = bytes.find("end_header\n");
    if (end == std::string::npos) fail(path + " is no PLY file");
    const std::string header = bytes.substr(0, end);
    const char* data = bytes.data() + end + strlen("end_header\n");
    const auto count = [&](const std::string& element) {
        const size_t at = header.find("element " + element + " ");
        return at == std::string::npos ? 0ul : strtoul(header.c_str() + at + 9 + element.size(), nullptr, 10);
    };
    const size_t vertices = count("vertex"), faces = count("face");
    Scene scene;
    if (header.find("property float radius") != std::string::npos) {
        scene.spheres.resize(vertices);
        memcpy(scene.spheres.data(), data, vertices * sizeof(Sphere));
        return scene;
    }
    scene.vertices.resize(vertices);
    memcpy(scene.vertices.data(), data, vertices * sizeof(Vec));
    scene.indices.resize(3 * faces);
    for (size_t i = 0; i < faces; i++) {
        Face face;
        memcpy(&face, data + vertices * sizeof(Vec) + i * sizeof(Face), sizeof face);
        memcpy(&scene.indices[3 * i], face.corners, sizeof face.corners);
    }
    return scene;
}
