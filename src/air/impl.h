#pragma once
// What Air holds.

#include <memory>
#include <string>
#include <vector>

#include "air/air.h"
#include "air/closed.h"
#include "air/compose.h"
#include "air/cone.h"
#include "air/cull.h"
#include "air/lamps.h"
#include "air/light.h"
#include "air/sky_light.h"
#include "air/walk.h"

namespace brume {

namespace air {

inline constexpr int kBlock =
    256;  ///< rays worked on together: their planes fit the cache

/// The kernels of one instruction set.
struct Kernels {
  ClosedKernels closed;
  ComposeKernels compose;
  ConeKernels cone;
  WalkKernels walk;
  LampKernels lamps;
  LightKernels light;
};
Kernels kernels_of(Isa);

/// One block of at most kBlock rays, a multiple of 16. `weights` one per stage (or null);
/// stage planes empty or three per stage.
struct Block {
  Rays rays;
  std::vector<const float*> weights;
  float *T[3], *L[3];
  std::vector<float*> stage_L, stage_T;
};

}  // namespace air

struct Air::Impl {
  air::Kernels kernels;
  air::Compiled world;  ///< points into the vectors below
  std::vector<air::Medium> media;
  bool bounded = false;      ///< some medium has a bounding sphere
  bool indifferent = false;  ///< no two media matter to each other where they overlap
  air::Candidates anywhere;  ///< all of them
  std::vector<std::string> media_names;
  std::vector<const air::Medium*> absorbers, casters;
  std::vector<air::Light> lights;  ///< as published, for irradiance
  std::vector<std::unique_ptr<air::SkyIrradiance>> skies;  ///< of those with a radiance
  std::vector<air::Light> steady, suns, lamps;
  std::vector<air::Shadower> shadowers;
  std::vector<brume_interface> interfaces;
  std::vector<brume_background> backgrounds;
  int stages = 0;

  void link();  ///< makes `world` point into the vectors
};

}  // namespace brume
