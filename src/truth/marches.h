#pragma once
// A view ray marched once. Internal to src/truth.

#include "truth/lights.h"
#include "truth/segments.h"

namespace brume::truth {

/// What a march is about: a stretch of a ray from `begin` on, the media that it meets,
/// and what is known of the ways of light to it.
struct Marched {
  const World& world;
  const Ray& ray;
  const Options& options;
  const Media& media;
  double begin;
  Lights& lights;
  Cost& cost;
};

/// T and L along it: by three colours, or where a medium of wavelengths is met by those.
/// Lights through detail are as well known as they are by now (Lights::refine_detail).
Answer march(const Marched&);

}  // namespace brume::truth
