// Measures rays per second of tinybvh on one thread, with the rays that `pathmark inspect rays SCENE --export FILE` wrote:
//
//   g++ -std=c++20 -O3 -march=native -I FOLDER_OF_TINY_BVH_H tinybvh.cpp -o tinybvh
//   tinybvh FILE [REPETITIONS] [f32|f64]
//
// Intersects incoherent rays, one by one. `f32`: BVH8_CPU, eight boxes at a time, built with spatial splits. `f64`: BVH_Double, a binary tree
// without SIMD, the only one of this library in double precision. The library has no nearest distance of a hit, so rays begin 1e-4 ahead of
// their origins. Prints the build time in seconds, the rays per second of each repetition, the number of rays that hit, and the sum of their
// distances.
#define TINYBVH_IMPLEMENTATION
#define NO_THREADED_BUILDS
#include <tiny_bvh.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "rays.h"

static const double NEAREST = 1e-4;

// `Corner` has at least three coordinates of the type `Number`; `Vector` has three.
template <typename Tree, typename Ray, typename Corner, typename Vector, typename Number, typename Build>
static void measure(const std::vector<double>& numbers, std::size_t triangles, std::size_t rays, int repetitions, Build build) {
  std::vector<Corner> corners(3 * triangles);
  for (std::size_t k = 0; k < 3 * triangles; k++)
    for (int axis = 0; axis < 3; axis++) corners[k][axis] = static_cast<Number>(numbers[3 * k + axis]);
  std::vector<Vector> origins(rays), directions(rays);
  for (std::size_t k = 0; k < rays; k++) {
    const double* ray = &numbers[9 * triangles + 7 * k];
    for (int axis = 0; axis < 3; axis++) {
      origins[k][axis] = static_cast<Number>(ray[axis] + NEAREST * ray[3 + axis]);
      directions[k][axis] = static_cast<Number>(ray[3 + axis]);
    }
  }

  Tree tree;
  const double begin = seconds();
  build(tree, corners.data());
  std::printf("build %.4f s\n", seconds() - begin);

  for (int repetition = 0; repetition < repetitions; repetition++) {
    std::size_t met = 0;
    double distance = 0;
    const double start = seconds();
    for (std::size_t k = 0; k < rays; k++) {
      Ray ray(origins[k], directions[k]);
      const Number farthest = ray.hit.t;
      tree.Intersect(ray);
      if (ray.hit.t < farthest) met++, distance += ray.hit.t + NEAREST;
    }
    const double rate = static_cast<double>(rays) / (seconds() - start);
    std::printf("%.0f rays/s, %zu met, distance %.9g\n", rate, met, distance);
  }
}

int main(int count, char** arguments) {
  if (count < 2) return std::fprintf(stderr, "usage: tinybvh FILE [REPETITIONS] [f32|f64]\n"), 2;
  const int repetitions = count > 2 ? std::atoi(arguments[2]) : 9;
  const bool is_double = count > 3 && std::strcmp(arguments[3], "f64") == 0;

  const auto [triangles, rays, numbers] = read_rays(arguments[1]);

  using namespace tinybvh;
  if (is_double)
    measure<BVH_Double, RayEx, bvhdbl3, bvhdbl3, double>(numbers, triangles, rays, repetitions,
                                                         [&](auto& tree, auto* corners) { tree.Build(corners, triangles); });
  else
    measure<BVH8_CPU, Ray, bvhvec4, bvhvec3, float>(
        numbers, triangles, rays, repetitions,
        [&](auto& tree, auto* corners) { tree.BuildHQ(corners, static_cast<std::uint32_t>(triangles)); });
}
