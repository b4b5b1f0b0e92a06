// Blocks of a case family's rays with their truth, for the tests that hold solvers against it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include <graze/experiments/cases.hpp>
#include <graze/experiments/specs.hpp>
#include <graze/experiments/truth.hpp>
#include <graze/surfaces/registry.hpp>

namespace graze::test {

/// Rays with their truth, and the surface at the scale they are meant for.
struct Block {
  SurfaceSpec spec;
  double size = 1;
  std::unique_ptr<truth::Surface> surface;
  std::vector<Ray> rays;
  std::vector<truth::Answer> truths;
};

/// The first `count` rays of the family's block of that number.
inline Block make_truths(const CaseFamily& family, const SurfaceSpec& spec, std::uint64_t seed,
                         std::size_t number, std::size_t count) {
  Block block;
  const double factor = block_scale(family, seed, number);
  block.spec = factor == 1 ? spec : graze::scaled(spec, factor);
  const auto surface = find_surface(spec.type).make(block.spec);
  block.size = surface->size();
  block.surface = truth::make_surface(block.spec);
  for (const CaseRay& ray : make_block(family, *surface, seed, number, count)) {
    block.rays.push_back(ray.ray);
    block.truths.push_back(block.surface->all(ray.ray, {.digits = 20}));
  }
  return block;
}

}  // namespace graze::test
