// Embree as a peer of the renderer: direct light with hard shadows by point samples, as a usual ray tracer takes them.
//
// usage: direct_light SCENE SIDE OUT
//
// Takes SIDE² samples a pixel, one in each of as many strata, in packets of 16 rays; shadow rays go in packets, too, and begin a little off
// the surface. Translucent surfaces are passed through, one after the other. Runs on one thread. Writes the picture to OUT as three little-endian floats
// a pixel, row by row, and prints "cpu_s SECONDS": building the tree and rendering, without reading and writing.
//
// SCENE is text, all numbers separated by white space (`studies/src/micropoint/embree.rs` writes it):
//   width height
//   eye, right, down, forward: x y z each, the axes of unit length; pixels per unit of x/depth
//   background: r g b
//   number of materials; for each: diffuse r g b, emission r g b, opacity
//   number of lights; for each: 0 for a point or 1 for a direction, its x y z, intensity or irradiance r g b, 1 if it casts shadows
//   number of vertices; for each: x y z
//   number of triangles; for each: three vertices and a material

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

struct Vector {
    double x = 0, y = 0, z = 0;
};
static Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
static Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
static Vector operator*(Vector a, double s) { return {a.x * s, a.y * s, a.z * s}; }
static Vector operator*(Vector a, Vector b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
static double dot(Vector a, Vector b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static Vector cross(Vector a, Vector b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

struct Material {
    Vector diffuse, emission;
    double opacity;
};
struct Light {
    bool directional, casts_shadow;
    Vector place, strength;
};
struct Scene {
    unsigned width, height;
    Vector eye, right, down, forward, background;
    double scale;
    std::vector<Material> materials;
    std::vector<Light> lights;
    std::vector<Vector> vertices;
    std::vector<unsigned> corners, material_of;
    // Of triangles, as wound.
    std::vector<Vector> normals;
    bool opaque = true;
};

[[noreturn]] static void fail(const char* what) {
    std::fprintf(stderr, "direct_light: %s\n", what);
    std::exit(1);
}

class Reader {
  public:
    explicit Reader(const char* path) : file(std::fopen(path, "r")) {
        if (!file) fail("the scene cannot be read");
    }
    ~Reader() { std::fclose(file); }
    double number() {
        double value;
        if (std::fscanf(file, "%lf", &value) != 1) fail("the scene ends early, or holds something that is no number");
        return value;
    }
    unsigned count() { return unsigned(number()); }
    Vector vector() {
        const double x = number(), y = number(), z = number();
        return {x, y, z};
    }

  private:
    std::FILE* file;
};

static Scene read_scene(const char* path) {
    Reader in(path);
    Scene s;
    s.width = in.count(), s.height = in.count();
    s.eye = in.vector(), s.right = in.vector(), s.down = in.vector(), s.forward = in.vector();
    s.scale = in.number();
    s.background = in.vector();
    for (unsigned n = in.count(); n > 0; --n) {
        const Vector diffuse = in.vector(), emission = in.vector();
        s.materials.push_back({diffuse, emission, in.number()});
        s.opaque = s.opaque && s.materials.back().opacity >= 1;
    }
    for (unsigned n = in.count(); n > 0; --n) {
        const bool directional = in.number() != 0;
        const Vector place = in.vector(), strength = in.vector();
        s.lights.push_back({directional, in.number() != 0, place, strength});
    }
    for (unsigned n = in.count(); n > 0; --n) s.vertices.push_back(in.vector());
    for (unsigned n = in.count(); n > 0; --n) {
        for (int k = 0; k < 3; ++k) s.corners.push_back(in.count());
        s.material_of.push_back(in.count());
        const unsigned* c = &s.corners[s.corners.size() - 3];
        const Vector a = s.vertices[c[0]], normal = cross(s.vertices[c[1]] - a, s.vertices[c[2]] - a);
        const double length = std::sqrt(dot(normal, normal));
        s.normals.push_back(length > 0 ? normal * (1 / length) : normal);
    }
    return s;
}

static RTCScene build(RTCDevice device, const Scene& s) {
    RTCScene tree = rtcNewScene(device);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    float* v = static_cast<float*>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, s.vertices.size()));
    for (const Vector& p : s.vertices) *v++ = float(p.x), *v++ = float(p.y), *v++ = float(p.z);
    void* t = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, s.material_of.size());
    std::copy(s.corners.begin(), s.corners.end(), static_cast<unsigned*>(t));
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(tree, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(tree);
    return tree;
}

// Numbers in 0..1 that follow from a state (splitmix64).
static double next_random(std::uint64_t& state) {
    std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return double((z ^ (z >> 31)) >> 11) / 9007199254740992.0;
}

constexpr unsigned LANES = 16;
// How far off a surface rays begin, relative to the distance from the eye. With 1e-5 the bias on the reference terrain is eight times as large;
// with 1e-7 surfaces would shadow themselves by the rounding of floats.
constexpr double OFF = 1e-6;

// What one sample of a packet sees so far.
struct Sample {
    Vector color;
    double passed = 1;
    unsigned pixel = 0;
};
// Where it is.
struct Hit {
    Vector position, normal;
    const Material* material = nullptr;
    double off = 0;
};

class Tracer {
  public:
    Tracer(const Scene& scene, RTCScene tree) : s(scene), tree(tree) {
        rtcInitIntersectContext(&coherent);
        coherent.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }

    // Traces the rays of a packet to the end, through what is translucent.
    void trace(const Vector* ways, Sample* samples, unsigned count) {
        alignas(64) int valid[LANES];
        alignas(64) RTCRayHit16 rays{};
        for (unsigned i = 0; i < LANES; ++i) {
            valid[i] = i < count ? -1 : 0;
            if (i < count) set_ray(rays.ray, i, s.eye, ways[i], 0, INFINITY);
        }
        for (bool any = true; any;) {
            any = false;
            for (unsigned i = 0; i < LANES; ++i) rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect16(valid, tree, &coherent, &rays);
            Hit hits[LANES];
            for (unsigned i = 0; i < LANES; ++i) {
                if (!valid[i]) continue;
                if (rays.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
                    samples[i].color = samples[i].color + s.background * samples[i].passed;
                    valid[i] = 0;
                    continue;
                }
                hits[i] = hit_of(rays.hit.primID[i], ways[i], rays.ray.tfar[i]);
            }
            shade(valid, hits, samples);
            for (unsigned i = 0; i < LANES; ++i) {
                if (!valid[i]) continue;
                samples[i].passed *= 1 - hits[i].material->opacity;
                if (samples[i].passed <= 0) {
                    valid[i] = 0;
                    continue;
                }
                set_ray(rays.ray, i, s.eye, ways[i], rays.ray.tfar[i] * (1 + OFF), INFINITY);
                any = true;
            }
        }
    }

  private:
    const Scene& s;
    RTCScene tree;
    RTCIntersectContext coherent;

    static void set_ray(RTCRay16& rays, unsigned i, Vector from, Vector way, double near, double far) {
        rays.org_x[i] = float(from.x), rays.org_y[i] = float(from.y), rays.org_z[i] = float(from.z);
        rays.dir_x[i] = float(way.x), rays.dir_y[i] = float(way.y), rays.dir_z[i] = float(way.z);
        rays.tnear[i] = float(near), rays.tfar[i] = float(far);
        rays.mask[i] = -1u, rays.flags[i] = 0, rays.time[i] = 0;
    }

    Hit hit_of(unsigned triangle, Vector way, double at) const {
        Hit hit;
        hit.normal = s.normals[triangle];
        if (dot(hit.normal, way) > 0) hit.normal = hit.normal * -1;
        hit.material = &s.materials[s.material_of[triangle]];
        hit.off = OFF * at * std::sqrt(dot(way, way));
        hit.position = s.eye + way * at;
        return hit;
    }

    // Adds what the hits of a packet emit and reflect.
    void shade(const int* valid, const Hit* hits, Sample* samples) {
        double shares[LANES];
        for (unsigned i = 0; i < LANES; ++i) {
            if (!valid[i]) continue;
            shares[i] = samples[i].passed * hits[i].material->opacity;
            samples[i].color = samples[i].color + hits[i].material->emission * shares[i];
        }
        for (const Light& light : s.lights) {
            alignas(64) int asked[LANES];
            alignas(64) RTCRay16 rays{};
            Vector irradiance[LANES];
            bool any = false;
            for (unsigned i = 0; i < LANES; ++i) {
                asked[i] = 0;
                if (!valid[i]) continue;
                const Vector to_light = light.directional ? light.place * -1 : light.place - hits[i].position;
                const double squared = dot(to_light, to_light), distance = std::sqrt(squared);
                const double cosine = dot(hits[i].normal, to_light) / distance;
                if (cosine <= 0) continue;
                irradiance[i] = light.strength * (light.directional ? cosine : cosine / squared);
                const Vector from = hits[i].position + hits[i].normal * hits[i].off;
                set_ray(rays, i, from, to_light, 0, light.directional ? INFINITY : 1 - 1e-6);
                asked[i] = -1;
                any = true;
            }
            if (!any) continue;
            double passed[LANES];
            std::fill(passed, passed + LANES, 1.0);
            if (light.casts_shadow) shadow(asked, rays, passed);
            for (unsigned i = 0; i < LANES; ++i) {
                if (!asked[i]) continue;
                const Vector reflected = hits[i].material->diffuse * irradiance[i];
                samples[i].color = samples[i].color + reflected * (shares[i] * passed[i] / M_PI);
            }
        }
    }

    // How much of a light passes along each ray.
    void shadow(const int* asked, RTCRay16& rays, double* passed) {
        if (s.opaque) {
            rtcOccluded16(asked, tree, &coherent, &rays);
            for (unsigned i = 0; i < LANES; ++i) passed[i] = asked[i] && rays.tfar[i] < 0 ? 0 : 1;
            return;
        }
        alignas(64) int valid[LANES];
        std::copy(asked, asked + LANES, valid);
        float far[LANES];
        std::copy(rays.tfar, rays.tfar + LANES, far);
        for (bool any = true; any;) {
            any = false;
            alignas(64) RTCRayHit16 query{};
            query.ray = rays;
            for (unsigned i = 0; i < LANES; ++i) query.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect16(valid, tree, &coherent, &query);
            for (unsigned i = 0; i < LANES; ++i) {
                if (!valid[i]) continue;
                if (query.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) {
                    valid[i] = 0;
                    continue;
                }
                passed[i] *= 1 - s.materials[s.material_of[query.hit.primID[i]]].opacity;
                rays.tnear[i] = query.ray.tfar[i] * float(1 + OFF);
                rays.tfar[i] = far[i];
                valid[i] = passed[i] > 0 ? -1 : 0;
                any = any || valid[i];
            }
        }
    }
};

static std::vector<Vector> render(const Scene& s, RTCScene tree, unsigned side) {
    std::vector<Vector> picture(std::size_t(s.width) * s.height);
    Tracer tracer(s, tree);
    Vector ways[LANES];
    Sample samples[LANES];
    unsigned filled = 0;
    const double share = 1.0 / (double(side) * side);
    auto flush = [&] {
        tracer.trace(ways, samples, filled);
        for (unsigned i = 0; i < filled; ++i) picture[samples[i].pixel] = picture[samples[i].pixel] + samples[i].color * share;
        filled = 0;
    };
    for (unsigned y = 0; y < s.height; ++y) {
        for (unsigned x = 0; x < s.width; ++x) {
            const unsigned pixel = y * s.width + x;
            std::uint64_t state = 0x5851f42d4c957f2du * (pixel + 1);
            for (unsigned k = 0; k < side * side; ++k) {
                const double px = x + (k % side + next_random(state)) / side - 0.5 * s.width;
                const double py = y + (k / side + next_random(state)) / side - 0.5 * s.height;
                ways[filled] = s.forward + s.right * (px / s.scale) + s.down * (py / s.scale);
                samples[filled] = Sample{};
                samples[filled].pixel = pixel;
                if (++filled == LANES) flush();
            }
        }
    }
    if (filled) flush();
    return picture;
}

static double cpu_seconds() {
    timespec time;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return double(time.tv_sec) + 1e-9 * double(time.tv_nsec);
}

int main(int count, char** arguments) {
    if (count != 4) {
        std::fprintf(stderr, "usage: direct_light SCENE SIDE OUT\n");
        return 2;
    }
    const Scene scene = read_scene(arguments[1]);
    RTCDevice device = rtcNewDevice("threads=1");
    const double start = cpu_seconds();
    RTCScene tree = build(device, scene);
    const std::vector<Vector> picture = render(scene, tree, unsigned(std::atoi(arguments[2])));
    std::printf("cpu_s %.6f\n", cpu_seconds() - start);
    std::FILE* out = std::fopen(arguments[3], "wb");
    if (!out) fail("the picture cannot be written");
    for (const Vector& p : picture) {
        const float color[3] = {float(p.x), float(p.y), float(p.z)};
        std::fwrite(color, sizeof color, 1, out);
    }
    std::fclose(out);
    rtcReleaseScene(tree);
    rtcReleaseDevice(device);
}
