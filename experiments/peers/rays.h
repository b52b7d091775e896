// The rays that `pathmark inspect rays SCENE --export FILE` wrote, and a clock, for programs that time other libraries along them.
#pragma once

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <vector>

struct Rays {
  std::size_t triangles = 0, rays = 0;
  // Nine for each triangle, then seven for each ray.
  std::vector<double> numbers;
};

static double seconds() {
  using namespace std::chrono;
  return duration<double>(steady_clock::now().time_since_epoch()).count();
}

// Ends the program with code 2 if the file has no such rays.
static Rays read_rays(const char* path) {
  Rays read;
  const auto refused = [path](const char* problem) {
    std::fprintf(stderr, "%s: %s\n", path, problem);
    std::exit(2);
  };
  std::FILE* file = std::fopen(path, "rb");
  if (!file || std::fscanf(file, "pathmark-rays 1 %zu %zu", &read.triangles, &read.rays) != 2 || std::fgetc(file) != '\n')
    refused("no rays of pathmark");
  read.numbers.resize(9 * read.triangles + 7 * read.rays);
  if (std::fread(read.numbers.data(), sizeof(double), read.numbers.size(), file) != read.numbers.size()) refused("ends early");
  std::fclose(file);
  return read;
}
