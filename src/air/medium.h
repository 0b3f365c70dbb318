#pragma once
// What the kernels see of the World: plain structs in float, positions relative to the
// eye, everything that can be worked out once worked out by compile.cpp.
//
//   rho      density along a ray [1]           D   its integral over a stretch [m]
//   sigma    extinction at rho = 1 [1/m]       tau = weight sigma D [1]
//   S        source radiance per unit extinction; where it is the same all along a ray
//            the medium is `closed`: its L is S (1 - e^-tau)

#include "plugin.h"

namespace brume::air {

inline constexpr float kFar = 3.0e38f;       ///< "forever", as a finite number [m]
inline constexpr float kMaxLength = 1e30f;   ///< longest stretch a profile integrates [m]
inline constexpr float kMaxExponent = 80.f;  ///< e^80 x 1e-30 m is still opaque

/// One medium. Capped media with coloured extinction come as one Medium per channel, so
/// that each has one end.
struct Medium {
  int stage = 0;
  int index = 0;  ///< in Compiled::media

  // bounds: local = A x + b
  brume_shape shape = BRUME_EVERYWHERE;
  float A[9] = {}, b[3] = {};
  float b2_minus_1 = 0;              ///< |b|^2 - 1, rounded once (ellipsoid)
  float center[3] = {}, radius = 0;  ///< bounding sphere; radius inf: none
  float start = 0;                   ///< not nearer to the eye than this [m]
  float cap = 0;                     ///< ends where weight x D reaches this; 0: never

  // profile
  brume_profile profile = BRUME_UNIFORM;
  float log_rho0 = 0;    ///< exponential: log rho at the eye
  float rho0 = 0;        ///< its exponential where that is a normal number, else 0
  float grad[3] = {};    ///< exponential: falloff x direction
  float middle[3] = {};  ///< lorentzian: its centre
  float falloff = 0;     ///< lorentzian: a [1/m^2]

  // what it does to light
  float sigma[3] = {};
  float densest = 0;       ///< the largest of them
  float S[3] = {};         ///< constant source, emission / sigma folded in
  float emission[3] = {};  ///< what cannot be folded: sigma (almost) 0 in that channel
  float albedo[3] = {};    ///< answer to lamps and, `sky_albedo`, to sun and sky
  float sky_albedo[3] = {};
  float g = 0;
  brume_phase phase = BRUME_HENYEY_GREENSTEIN;
  bool grey = false;          ///< sigma equal in all channels
  bool absorbs = false;       ///< some sigma > 0
  bool emits = false;         ///< some emission != 0
  bool glows_by_sun = false;  ///< sky_albedo != 0 and the world has a sun or sky light
  bool glows_by_lamp = false;
  bool closed = false;  ///< source constant along every ray
  int source = 0;       ///< closed media with the same source have the same number

  const void* self = nullptr;
  brume_integral_fn integral = nullptr;
  brume_density_fn density = nullptr;
  brume_source_fn source_at = nullptr;
  brume_alone_fn alone = nullptr;
};

struct Light {
  brume_light_kind kind = BRUME_SUN;
  float position[3] = {};   ///< relative to the eye
  float direction[3] = {};  ///< unit
  float power[3] = {};
  float radius2 = 0;  ///< a lamp is no brighter than at its own surface [m^2]
  float near2 = 0;    ///< that, or where its light would leave the floats [m^2]
  float sin2_cone = 1, sin2_inner = 1;  ///< spot: sin^2 of the half angle, and of where
                                        ///< it begins to fade
  float cone = 0, cone_soft = 0;
  int cone_falloff = 0;
  bool attenuated = false;  ///< media and shadowers lie between
  bool closed = false;      ///< a lamp whose glow has a closed form: see glow_form.h
};

struct Shadower {
  const void* self;
  brume_shadow_fn optical_depth;
};

/// A span that a kernel may loop over: never a call.
template <class T>
struct List {
  const T* data = nullptr;
  int size = 0;
  [[gnu::always_inline]] const T* begin() const { return data; }
  [[gnu::always_inline]] const T* end() const { return data + size; }
};

/// The whole world, for kernels.
struct Compiled {
  List<Medium> media;             ///< in canonical order
  List<const Medium*> absorbers;  ///< those that stand between a lamp and a point
  List<const Medium*> casters;    ///< of these, boxes and ellipsoids
  List<Light> steady;             ///< suns and sky light that nothing attenuates
  List<Light> suns;               ///< attenuated suns
  List<Light> lamps;              ///< point and spot lights
  List<Shadower> shadowers;
  bool grey = false;  ///< all that stands between dims all channels alike
  float tolerance = 1e-3f;
  float scale = 1;  ///< min(white, the largest source): errors are measured against it
};

/// n rays, n a multiple of 16. Null origins: all at the eye; null begin: 0.
struct Rays {
  int n = 0;
  const float *ox = nullptr, *oy = nullptr, *oz = nullptr;
  const float *dx = nullptr, *dy = nullptr, *dz = nullptr;
  const float* begin = nullptr;
  const float* end = nullptr;
};

/// One medium on n rays: where it is (lo = hi = kFar: nowhere), what it lets through and
/// adds. lo, hi may be null together, and L alone.
struct Stretch {
  float *lo = nullptr, *hi = nullptr;
  float* T[3] = {};
  float* L[3] = {};
};

}  // namespace brume::air
