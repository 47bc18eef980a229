/* Rays through Embree 4, one after the other, for embree.py.
 *
 *     gcc -O2 -shared -fPIC embree_rays.c -o embree_rays.so path/to/libembree4.so.4
 *
 * The few declarations of Embree's interface that are needed stand here [Embree 4.4, include/embree4], so that the
 * library of a Python wheel, which comes without headers, will do.
 */
#define _GNU_SOURCE
#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <time.h>

typedef void *Handle;

/* RTCRayHit: RTCRay, then RTCHit with room for what newer versions add. */
typedef struct __attribute__((aligned(16))) {
    float origin[3], tnear, direction[3], time, tfar;
    uint32_t mask, id, flags;
    float normal[3], u, v;
    uint32_t primitive, geometry, more[9];
} RayHit;

/* RTCFilterFunctionNArguments */
typedef struct {
    int *valid;
    void *user;
    void *context, *ray, *hit;
    unsigned count;
} FilterArguments;

Handle rtcNewDevice(const char *);
Handle rtcNewScene(Handle);
void rtcSetSceneFlags(Handle, int);
void rtcSetSceneBuildQuality(Handle, int);
Handle rtcNewGeometry(Handle, int);
void rtcSetSharedGeometryBuffer(Handle, int, unsigned, int, const void *, size_t, size_t, size_t);
void rtcSetGeometryUserData(Handle, void *);
void rtcSetGeometryIntersectFilterFunction(Handle, void (*)(const FilterArguments *));
void rtcCommitGeometry(Handle);
unsigned rtcAttachGeometry(Handle, Handle);
void rtcCommitScene(Handle);
void rtcIntersect1(Handle, RayHit *, void *);
void rtcOccluded1(Handle, RayHit *, void *);

enum { TRIANGLES = 0, INDEX = 0, VERTEX = 1, UINT3 = 0x5003, FLOAT3 = 0x9003, ROBUST = 4, MEDIUM = 1 };

static uint64_t every;

/* Counts a hit and refuses it, so that the ray goes on to its end. */
static void count_and_go_on(const FilterArguments *arguments) {
    every += 1;
    arguments->valid[0] = 0;
}

Handle new_device(void) { return rtcNewDevice("threads=1"); }

/* A scene of one mesh; with a filter for the rays that ask for every hit. */
Handle new_scene(Handle device, const float *vertices, size_t vertex_count, const uint32_t *triangles,
                 size_t triangle_count, int robust, int filter) {
    Handle scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, robust ? ROBUST : 0);
    rtcSetSceneBuildQuality(scene, MEDIUM);
    Handle mesh = rtcNewGeometry(device, TRIANGLES);
    rtcSetSharedGeometryBuffer(mesh, VERTEX, 0, FLOAT3, vertices, 0, 12, vertex_count);
    rtcSetSharedGeometryBuffer(mesh, INDEX, 0, UINT3, triangles, 0, 12, triangle_count);
    if (filter) rtcSetGeometryIntersectFilterFunction(mesh, count_and_go_on);
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcCommitScene(scene);
    return scene;
}

static double thread_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* CPU seconds of all rays, seven numbers each; the question is 0 for the nearest hit, 1 for any, 2 for every. */
double trace(Handle scene, const float *rays, size_t count, int question, uint64_t *hits) {
    uint64_t found = 0;
    every = 0;
    double start = thread_seconds();
    for (size_t i = 0; i < count; ++i) {
        const float *ray = rays + 7 * i;
        RayHit query = {
            .origin = {ray[0], ray[1], ray[2]},
            .direction = {ray[3], ray[4], ray[5]},
            .tfar = ray[6],
            .mask = UINT32_MAX,
            .geometry = UINT32_MAX,
        };
        if (question == 1) {
            rtcOccluded1(scene, &query, NULL);
            found += query.tfar == -INFINITY;
        } else {
            rtcIntersect1(scene, &query, NULL);
            found += query.geometry != UINT32_MAX;
        }
    }
    *hits = question == 2 ? every : found;
    return thread_seconds() - start;
}
