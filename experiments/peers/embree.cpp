// Measures rays per second of Embree on one thread, with the rays that `pathmark inspect rays SCENE --export FILE` wrote:
//
//   embree FILE [REPETITIONS] [robust|fast]
//
// Calls rtcIntersect1 with incoherent rays, one by one, in single precision because Embree has no other. `robust` sets RTC_SCENE_FLAG_ROBUST.
// Rays begin at a distance of 1e-4, as in renderers that do not remember the surface on which a ray starts.
// Prints the build time in seconds, the rays per second of each repetition, the number of rays that hit, and the sum of their distances.
#include <embree3/rtcore.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "rays.h"

struct Start {
  float origin[3], direction[3];
};

int main(int count, char** arguments) {
  if (count < 2) return std::fprintf(stderr, "usage: embree FILE [REPETITIONS] [robust|fast]\n"), 2;
  const int repetitions = count > 2 ? std::atoi(arguments[2]) : 9;
  const bool robust = count <= 3 || std::strcmp(arguments[3], "fast") != 0;

  const auto [triangles, rays, numbers] = read_rays(arguments[1]);

  RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
  RTCScene scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  if (robust) rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                              3 * sizeof(float), 3 * triangles));
  auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                                 3 * sizeof(unsigned), triangles));
  for (std::size_t k = 0; k < 9 * triangles; k++) corners[k] = static_cast<float>(numbers[k]);
  for (std::size_t k = 0; k < 3 * triangles; k++) indices[k] = static_cast<unsigned>(k);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  const double begin = seconds();
  rtcCommitScene(scene);
  std::printf("build %.4f s\n", seconds() - begin);

  std::vector<Start> starts(rays);
  for (std::size_t k = 0; k < rays; k++)
    for (int axis = 0; axis < 3; axis++) {
      starts[k].origin[axis] = static_cast<float>(numbers[9 * triangles + 7 * k + axis]);
      starts[k].direction[axis] = static_cast<float>(numbers[9 * triangles + 7 * k + 3 + axis]);
    }

  for (int repetition = 0; repetition < repetitions; repetition++) {
    std::size_t met = 0;
    double distance = 0;
    const double start = seconds();
    for (const Start& ray : starts) {
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      RTCRayHit hit;
      hit.ray.org_x = ray.origin[0], hit.ray.org_y = ray.origin[1], hit.ray.org_z = ray.origin[2];
      hit.ray.dir_x = ray.direction[0], hit.ray.dir_y = ray.direction[1], hit.ray.dir_z = ray.direction[2];
      hit.ray.tnear = 1e-4f, hit.ray.tfar = __builtin_inff();
      hit.ray.time = 0, hit.ray.mask = ~0u, hit.ray.id = 0, hit.ray.flags = 0;
      hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(scene, &context, &hit);
      if (hit.hit.geomID != RTC_INVALID_GEOMETRY_ID) met++, distance += hit.ray.tfar;
    }
    const double rate = static_cast<double>(rays) / (seconds() - start);
    std::printf("%.0f rays/s, %zu met, distance %.9g\n", rate, met, distance);
  }
  rtcReleaseGeometry(geometry), rtcReleaseScene(scene), rtcReleaseDevice(device);
}
