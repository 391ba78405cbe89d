// The same rays through the same triangles by Embree 3, on one thread.
//
//     rays DIRECTORY default|robust
//
// reads DIRECTORY/triangles (nine floats each), then commands from standard input, one to a line, and
// answers each with the seconds it took:
//
//     closest NAME   the first hit of every ray in DIRECTORY/NAME (origin and direction, six floats)
//     shadow NAME    whether something is between every pair of points in DIRECTORY/NAME (six floats)
//     find NAME      as closest, and writes the distances to DIRECTORY/NAME.found (infinite: no hit)
//     check NAME     as shadow, and writes 0 (something is between) or infinity for every pair
#include <embree3/rtcore.h>
#include <pmmintrin.h>
#include <xmmintrin.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

namespace {

constexpr float INFINITE = std::numeric_limits<float>::infinity();

// As `SHADOW_END` of Metrolight: a shadow ray ends a little before its target.
constexpr float SHADOW_END = 1.0f - 1e-6f;

struct Six {
    float a[3], b[3];
};

template <typename T> std::vector<T> read(const std::string &path) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file) {
        std::cerr << "cannot read " << path << "\n";
        std::exit(2);
    }
    std::vector<T> items(static_cast<size_t>(file.tellg()) / sizeof(T));
    file.seekg(0);
    file.read(reinterpret_cast<char *>(items.data()), items.size() * sizeof(T));
    return items;
}

RTCScene build(RTCDevice device, const std::vector<float> &corners, bool robust) {
    RTCScene scene = rtcNewScene(device);
    if (robust)
        rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    const size_t vertices = corners.size() / 3;
    void *positions = rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices);
    std::memcpy(positions, corners.data(), corners.size() * sizeof(float));
    auto *indices = static_cast<unsigned *>(rtcSetNewGeometryBuffer(
        mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), vertices / 3));
    for (size_t i = 0; i < vertices; ++i)
        indices[i] = static_cast<unsigned>(i);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene);
    return scene;
}

RTCRay ray(const float origin[3], float dx, float dy, float dz, float end) {
    RTCRay ray = {};
    ray.org_x = origin[0];
    ray.org_y = origin[1];
    ray.org_z = origin[2];
    ray.dir_x = dx;
    ray.dir_y = dy;
    ray.dir_z = dz;
    ray.tfar = end;
    ray.mask = ~0u;
    return ray;
}

// Calls `store` with the distance of every first hit.
template <typename Store>
void closest(RTCScene scene, const std::vector<Six> &rays, Store store) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (const Six &r : rays) {
        RTCRayHit hit = {};
        hit.ray = ray(r.a, r.b[0], r.b[1], r.b[2], INFINITE);
        hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &hit);
        store(hit.hit.geomID == RTC_INVALID_GEOMETRY_ID ? INFINITE : hit.ray.tfar);
    }
}

// Calls `store` with 0 for every pair that something is between, else with infinity.
template <typename Store>
void shadow(RTCScene scene, const std::vector<Six> &pairs, Store store) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (const Six &p : pairs) {
        RTCRay segment = ray(p.a, p.b[0] - p.a[0], p.b[1] - p.a[1], p.b[2] - p.a[2], SHADOW_END);
        rtcOccluded1(scene, &context, &segment);
        store(segment.tfar < 0.0f ? 0.0f : INFINITE);
    }
}

// Of this thread, so that it matters little what else the machine does.
double seconds() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

} // namespace

int main(int argc, char **argv) {
    if (argc != 3) {
        std::cerr << "usage: rays DIRECTORY default|robust\n";
        return 2;
    }
    // As Embree's manual advises.
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    const std::string directory = std::string(argv[1]) + "/";
    RTCDevice device = rtcNewDevice("threads=1");
    RTCScene scene =
        build(device, read<float>(directory + "triangles"), !std::strcmp(argv[2], "robust"));

    std::string verb, name, loaded;
    std::vector<Six> rays;
    while (std::cin >> verb >> name) {
        if (name != loaded)
            rays = read<Six>(directory + name);
        loaded = name;
        const bool any = verb == "shadow" || verb == "check";
        const double start = seconds();
        if (verb == "closest" || verb == "shadow") {
            size_t hits = 0;
            auto count = [&](float t) { hits += t < INFINITE; };
            any ? shadow(scene, rays, count) : closest(scene, rays, count);
            const double taken = seconds() - start;
            std::cout << taken << " " << hits << std::endl;
        } else {
            std::vector<float> found;
            auto keep = [&](float t) { found.push_back(t); };
            any ? shadow(scene, rays, keep) : closest(scene, rays, keep);
            std::ofstream file(directory + name + ".found", std::ios::binary);
            file.write(reinterpret_cast<char *>(found.data()), found.size() * sizeof(float));
            file.close();
            std::cout << seconds() - start << " 0" << std::endl;
        }
    }
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
    return 0;
}
