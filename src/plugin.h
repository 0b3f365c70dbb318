/* brume's plugin interface: plain C, self-contained. A stage plugin needs nothing but this header.
 *
 * A module exports one symbol, brume_plugin, that returns the stages it carries. The host asks a stage
 *   create   with the parameter values of one frame, checked against the stage's own table,
 *   needs    what it wants to read and change, or why it has nothing to do,
 *   publish  what there is in the world: media, lights, shadowers, interfaces, a background (air stages; any role may),
 *   run      to change pixels (surface and lens stages only: air is integrated by the host, all stages together),
 * and destroys it after the frame. Frames are worked on at the same time: each has its own instance, and `run` and every
 * function a stage publishes are called from several threads at once.
 *
 * Rules of the border: no C++ types and no exceptions cross it. Every struct begins with its size as its writer knows it, so that
 * either side may be older. Text is UTF-8, owned by whoever passes it and valid until the call returns (static where it is part
 * of a table). Numbers of pixels are planar float spans. Lengths are metres, angles radians, colour scene-linear in the frame's primaries.
 * World positions cross as double; the positions of rays are float relative to the eye (brume_frame.eye), so that a
 * planet-sized world costs no precision.
 */
#ifndef BRUME_PLUGIN_H
#define BRUME_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define BRUME_ABI 2

typedef enum brume_status {
  BRUME_OK = 0,
  BRUME_FAILED = 1,     /* say why with host->fail */
  BRUME_NO_MEMORY = 2
} brume_status;

/* ---- parameters --------------------------------------------------------------------------------------------------- */

typedef enum brume_kind { /* order as brume::Kind */
  BRUME_NUMBER, BRUME_INTEGER, BRUME_FLAG, BRUME_RGB, BRUME_VEC3, BRUME_NUMBERS, BRUME_MATRIX, BRUME_TEXT, BRUME_CHOICE
} brume_kind;

enum { BRUME_PARAM_KNOB = 1,      /* the stage's accuracy knob: set from the scene's tolerance unless given */
       BRUME_PARAM_STATIC = 2,    /* may not be keyframed */
       BRUME_PARAM_INFINITE = 4 };  /* inf may be given (where the range reaches it) */

typedef struct brume_param {
  size_t size;
  const char* name;
  brume_kind kind;
  const char* unit;             /* "1/m", "" */
  const char* doc;              /* one sentence */
  double minimum, maximum;      /* inclusive, per component; -inf, inf for no bound */
  const double* default_numbers;
  size_t default_count;
  const char* default_text;     /* text, choice, or an rgb given as a word; else "" */
  const char* words;            /* "box|ellipsoid": a choice's words, or words an rgb takes in place of numbers; else "" */
  uint32_t flags;
  /* Of a knob: values and the error that each promises (|dC| <= error (white + |C|)), measured, cheapest first, errors falling:
   * value, error, value, error, ... The host takes the first that is good enough. */
  const double* curve;
  size_t curve_count;             /* numbers in it */
} brume_param;

/* A parameter's value at the frame. One number for number, integer, flag; three for rgb, vec3; 16 for matrix. */
typedef struct brume_value {
  const double* numbers;
  size_t count;
  const char* text;             /* "" where numbers hold */
} brume_value;

/* ---- the frame and the host ---------------------------------------------------------------------------------------- */

typedef enum brume_projection { BRUME_PERSPECTIVE, BRUME_ORTHOGRAPHIC, BRUME_LATLONG } brume_projection;

typedef struct brume_frame {
  size_t size;
  double frame, time, fps;            /* frame number; seconds since [time] origin; frames per second */
  double eye[3], up[3], forward[3];   /* world; up is the world's, forward the camera's; unit vectors */
  int has_camera;                     /* 0: positions mean nothing, only distances do */
  double pixel_footprint;             /* angle between neighbouring rays in the middle [rad] (orthographic: distance [m]) */
  int display_x, display_y, display_width, display_height;
  double tolerance, white;            /* what numerical error the user accepts: |dC| <= tolerance (white + |C|) */
  double chromaticities[8];           /* rx ry gx gy bx by wx wy of the frame's primaries */
  int has_sun;
  double to_sun[3];                   /* unit */
  double sun_irradiance[3];           /* [sun] irradiance; 0: not given */
  int orthographic;                   /* rays are parallel, and pixel_footprint is a distance */
  double camera_right[3], camera_up[3]; /* with `forward` the camera's axes */
  const char* const* channels;        /* of the frame's own file; valid during the call */
  size_t channel_count;
  /* Where every pixel looks. With p = corner + x across + y down, x and y in pixels of the image (centres at .5), its ray is
   *   perspective:   from the eye through eye + p, p[m]: forward . p is 1 (or nearly: sheared cameras)
   *   orthographic:  from eye + p along forward, p[m]
   *   latlong:       from the eye; 2 pi p[0] its longitude, from forward toward camera_right, and 2 pi p[1] its elevation toward camera_up
   * So a pixel's width is known at any place (stage/footprint.h), where pixel_footprint is that of the middle. A stage that meets
   * a projection it does not know goes by pixel_footprint alone. All 0 without a camera. */
  int projection;                     /* brume_projection */
  double corner[3], across[3], down[3];
  double mix;                         /* this stage's own, in (0, 1]: an air stage's weight along rays that no mask takes from */
} brume_frame;

/* Valid during the call that it is passed to. */
typedef struct brume_host brume_host;
struct brume_host {
  size_t size;
  uint32_t abi;
  void* context;
  /* Says why the current call will return BRUME_FAILED; one line, the host adds file and stage. */
  void (*fail)(const brume_host*, const char* message);
  /* A table shared by frames and stages: the object known under `key`, made by `build` when it is not there (one thread builds, others wait;
   * NULL from build: failed). Key everything it depends on. Lives as long as the pipeline. */
  const void* (*shared)(const brume_host*, const char* key, void* (*build)(void*), void* argument, void (*destroy)(void*));
};

/* ---- what a stage needs --------------------------------------------------------------------------------------------- */

enum { BRUME_LINEAR = 1,        /* out(a I + b J) = a out(I) + b out(J) for light I, J and numbers a, b >= 0 */
       BRUME_KEEPS_LIGHT = 2 }; /* light is moved, none made: summed over the frame it grows no larger */

/* Comes with every field at the value that asks for nothing (farthest: inf). Text and lists put into it live until needs is called
 * again or the stage is destroyed. */
typedef struct brume_needs {
  size_t size;
  const char* idle;               /* not NULL: the stage has nothing to do at this frame, and this is why ("density is 0") */
  const char* const* channels;    /* further channels it reads ("N.X"), delivered to run in this order */
  size_t channel_count;
  const char* const* optional;    /* channels it can do without: NULL in run where the frame has none */
  size_t optional_count;
  int needs_camera, needs_depth;
  int whole_frame;                /* lens: wants the frame as one tile */
  int rows_around, columns_around;
  int changes_alpha;
  int screen[4];                  /* x, y, width, height in display pixels outside which nothing changes; width 0: everywhere */
  double nearest, farthest;       /* distance interval [m] in which it can matter; 0, inf: all */
  uint32_t lights;                /* surface: kinds of light it answers to, BRUME_LIGHT_BIT of each; left out where there are none of them. 0: all the same */
  uint32_t laws;                  /* lens: what it promises at these values, BRUME_LINEAR | BRUME_KEEPS_LIGHT; `brume stress` holds it to them */
  /* Surface stages without a knob: what they may be off by numerically at these values, |dC| <= promise (white + |C|); 0: next to nothing. */
  double promise;
} brume_needs;

/* ---- rays and points in spans ----------------------------------------------------------------------------------------- */

/* n rays. Origins are relative to the eye; NULL: all at the eye. Directions are unit vectors. */
typedef struct brume_rays {
  size_t n;
  const float *ox, *oy, *oz;
  const float *dx, *dy, *dz;
} brume_rays;

/* ---- what there is: media --------------------------------------------------------------------------------------------- */

typedef enum brume_shape {
  BRUME_EVERYWHERE,   /* no bounds */
  BRUME_HALF_SPACE,   /* local z <= 0 */
  BRUME_BOX,          /* local |x|, |y|, |z| <= 1 */
  BRUME_ELLIPSOID     /* local x^2 + y^2 + z^2 <= 1 */
} brume_shape;

/* Density rho along a ray, times the medium's coefficients per metre. Each has an exact integral; `custom` brings its own. */
typedef enum brume_profile {
  BRUME_UNIFORM,      /* rho = 1 */
  BRUME_EXPONENTIAL,  /* rho = exp(-falloff dot(direction, x - origin)), direction a unit vector */
  BRUME_LORENTZIAN,   /* rho = 1 / (1 + falloff |x - origin|^2), falloff in 1/m^2 */
  BRUME_CUSTOM
} brume_profile;

/* integral[i] = Int rho ds over [t0[i], t1[i]] of ray i, t in metres along it, 0 <= t0 <= t1 <= inf. */
typedef void (*brume_integral_fn)(const void* self, const brume_rays*, const float* t0, const float* t1, float* integral);
/* rho at t[i] along ray i. */
typedef void (*brume_density_fn)(const void* self, const brume_rays*, const float* t, float* density);
/* Source radiance (per unit extinction) at t[i] along ray i, seen from the ray's origin side: rgb planes. */
typedef void (*brume_source_fn)(const void* self, const brume_rays*, const float* t, float* r, float* g, float* b);
/* The medium alone over [t0, t1], weights[i] times as dense along ray i (extinction and emission; its source stays. NULL: 1): what it adds, and
 * its transmittance, as rgb planes (closed form or table). */
typedef void (*brume_alone_fn)(const void* self, const brume_rays*, const float* weights, const float* t0, const float* t1, float* const L[3],
                               float* const T[3]);
/* The same physics at one point in double, for the truth: density, and (where there is a custom source) the source radiance toward -direction. */
typedef void (*brume_point_fn)(const void* self, const double position[3], const double direction[3], double* density, double source[3]);

/* Factors on the medium's extinction at a point, rgb, in double for the truth. Its T and L come from `alone`. */
typedef void (*brume_tint_fn)(const void* self, const double position[3], double rgb[3]);
/* The same by wavelength, each wavelength of its own (brume_medium.wavelengths): extinction per metre and source radiance per unit extinction. */
typedef void (*brume_spectral_point_fn)(const void* self, const double position[3], const double direction[3], double* extinction, double* source);

typedef enum brume_phase { BRUME_HENYEY_GREENSTEIN, BRUME_RAYLEIGH, BRUME_CORNETTE_SHANKS } brume_phase;

typedef enum brume_source {
  BRUME_SOURCE_COLOR,  /* `color`, the same everywhere and in all directions: the artist's */
  BRUME_SOURCE_SKY,    /* sun and sky of the world, by phase function */
  BRUME_SOURCE_CUSTOM  /* the medium's own function */
} brume_source;

/* At each point: extinction per metre = rho extinction; light added per metre = rho (emission + extinction (source + albedo lights)). */
typedef struct brume_medium {
  size_t size;
  const char* name;               /* "" : the stage's; a stage that publishes several names each */
  brume_shape shape;
  double local_from_world[12];    /* 3 x 4, row by row, world metres */
  brume_profile profile;
  double origin[3], direction[3], falloff;  /* custom: how its smooth part falls, if it does (0: not said) */
  double extinction[3];           /* [1/m] at rho = 1 */
  double albedo[3], g;            /* answer to lights */
  brume_phase phase;
  brume_source source;
  double color[3];
  double emission[3];             /* radiance per metre at rho = 1 */
  double start;                   /* nearer than this to the eye it is not there [m] */
  double max_opacity;             /* it ends where its optical depth from the eye reaches -ln(1 - max_opacity); 1: never */
  const void* self;               /* first argument of the functions below; lives until destroy */
  brume_integral_fn integral;     /* profile custom */
  brume_density_fn density;       /* profile custom */
  brume_source_fn source_at;      /* source custom */
  brume_alone_fn alone;           /* optional */
  brume_point_fn point;           /* profile or source custom */
  int is_sky;                     /* the clear sky itself: left out before a plate that already shows one */
  brume_tint_fn tint;             /* optional, profile custom: colour of its extinction where that changes from place to place */
  /* Optional: a medium whose colours are sums over wavelengths says so to the truth. Along a ray, colour c of its light is
   * Sum_i spectral_radiance[3 i + c] L_i, no less than 0, and its transmittance Sum_i spectral_transmittance[3 i + c] T_i. The arrays live until destroy. */
  const double *spectral_radiance, *spectral_transmittance;
  brume_spectral_point_fn spectral_point;
  int wavelengths;                /* 0: it has three colours */
  /* Optional: middle and radius [m] of a ball where a ray ends for it that ends nowhere else and begins outside (or less than 1e-9 of the
   * radius within); and the radius of a smaller one about the same middle where every ray ends, or begins that comes out of it. Kernels know, the truth is told. */
  double ground[4], core;
} brume_medium;

/* ---- lights, shadowers, interfaces, background -------------------------------------------------------------------------- */

typedef enum brume_light_kind {
  BRUME_SUN,        /* from `direction` (toward the light): irradiance `power` on a plane facing it */
  BRUME_SKY_LIGHT,  /* from everywhere: mean radiance `power`; by direction where `radiance` is given */
  BRUME_POINT,      /* at `position`: radiant intensity `power` per steradian, falls with 1/r^2 */
  BRUME_SPOT        /* the same inside a cone about `direction` (where it shines to) */
} brume_light_kind;
#define BRUME_LIGHT_BIT(kind) (1u << (kind))

/* Radiance arriving from directions rays->d at the points rays->o (relative to the eye). */
typedef void (*brume_radiance_fn)(const void* self, const brume_rays*, float* r, float* g, float* b);

typedef struct brume_light {
  size_t size;
  const char* name;
  brume_light_kind kind;
  double position[3], direction[3];
  double power[3];
  double radius;                  /* of the lamp [m], or angular of the sun [rad] */
  double cone, cone_soft;         /* spot: half angle, and the angle over which its edge fades (inside it) [rad] */
  int cone_falloff;               /* 0: smooth edge over cone_soft; 1: saturate(|cone / theta| - 1), Intel 2008 */
  int attenuated;                 /* media lie between light and point (1), or the light ignores them (0) */
  const void* self;
  brume_radiance_fn radiance;
} brume_light;

/* Optical depth (rgb planes) from the points rays->o along rays->d over [0, t1], for what is no medium (terrain, a cloud map). */
typedef void (*brume_shadow_fn)(const void* self, const brume_rays*, const float* t1, float* r, float* g, float* b);
typedef struct brume_shadower {
  size_t size;
  const char* name;
  const void* self;
  brume_shadow_fn optical_depth;
} brume_shadower;

/* A surface in mid-air (water): where ray i meets it first at t > 0 (inf: never), with unit normal facing the ray's origin and reflectance R. */
typedef void (*brume_hit_fn)(const void* self, const brume_rays*, float* t, float* nx, float* ny, float* nz, float* reflectance);
typedef struct brume_interface {
  size_t size;
  const char* name;
  const void* self;
  brume_hit_fn hit;
} brume_interface;

/* Radiance from beyond all air in the directions of the rays (sun disc, stars). */
typedef struct brume_background {
  size_t size;
  const char* name;
  const void* self;
  brume_radiance_fn radiance;
} brume_background;

/* Handed to publish. Structs are copied; the functions and `self` in them must live until destroy. Returns BRUME_OK, or
 * BRUME_FAILED (already reported) for a struct that makes no sense (non-finite, albedo > 1, missing function). */
typedef struct brume_publisher brume_publisher;
struct brume_publisher {
  size_t size;
  void* context;
  brume_status (*medium)(brume_publisher*, const brume_medium*);
  brume_status (*light)(brume_publisher*, const brume_light*);
  brume_status (*shadower)(brume_publisher*, const brume_shadower*);
  brume_status (*interface_)(brume_publisher*, const brume_interface*);
  brume_status (*background)(brume_publisher*, const brume_background*);
};

/* ---- pixels, for surface and lens stages ------------------------------------------------------------------------------- */

/* What a surface stage may ask of the world while it runs: light transport through everything all stages published. */
typedef struct brume_world {
  size_t size;
  const void* context;
  /* Transmittance (rgb planes) of all media along rays over [0, t1]. */
  void (*transmittance)(const struct brume_world*, const brume_rays*, const float* t1, float* const T[3]);
  /* Irradiance on planes at points rays->o with unit normals rays->d from light k, attenuated by the media between. A sky light is not
   * attenuated and taken as it is at the eye. Finite; 0 for light >= light_count. */
  void (*irradiance)(const struct brume_world*, size_t light, const brume_rays*, float* const E[3]);
  size_t light_count;
  /* Light k as it was published (its name ""), in an order that the scene file's does not change; NULL for k >= light_count. Lives as long as the frame. */
  const brume_light* (*light)(const struct brume_world*, size_t k);
} brume_world;

typedef struct brume_tile {
  size_t size;
  int x, y, width, height;        /* display pixels */
  ptrdiff_t row_stride;           /* floats from row to row, for every plane */
  float *r, *g, *b, *a;           /* premultiplied; read and changed */
  const float* distance;          /* along the ray [m], inf: background; NULL unless needs_depth */
  const float *dx, *dy, *dz;      /* unit ray directions; NULL unless needs_camera */
  const float* const* channels;   /* those of brume_needs, then the optional ones (NULL where missing) */
  /* distance, rays and channels reach rows_around and columns_around beyond the tile on each side (replicated at the
   * frame's edges); every plane's rows are row_stride apart. A covered pixel without depth has its nearest neighbour's distance. */
  const brume_world* world;       /* surface stages; NULL for lens stages */
  const float *ox, *oy, *oz;      /* ray origins relative to the eye; NULL: all at the eye */
} brume_tile;

/* ---- a stage ------------------------------------------------------------------------------------------------------------- */

typedef enum brume_role { BRUME_SURFACE, BRUME_AIR, BRUME_LENS } brume_role;
/* Order among surface stages: light decides (background, then shadow, then added light, then interfaces). */
typedef enum brume_surface_step { BRUME_BACKGROUND_STEP, BRUME_SHADOW_STEP, BRUME_LIGHT_STEP, BRUME_INTERFACE_STEP } brume_surface_step;

/* The same air as the document computes it that the effect comes from, for `brume study` to compare with: what the stage adds
 * alone over [0, t1[i]] of ray i, and its transmittance, as rgb planes. After publish. BRUME_FAILED where the document has
 * no answer for these parameters. */
typedef brume_status (*brume_baseline_fn)(void* self, const brume_host*, const brume_rays*, const float* t1,
                                          float* const L[3], float* const T[3]);

/* What run must make of the n pixels (xy[2k], xy[2k+1]) of a tile, counted from its corner, in double: rgb[3k + channel]. Another way than
 * run's, as slow as it need be, for `brume study` and `brume stress` to hold run against. The tile is as run is given it, and stays so. */
typedef brume_status (*brume_truth_fn)(void* self, const brume_host*, const brume_tile*, size_t n, const int* xy, double* rgb);

typedef struct brume_stage {
  size_t size;
  const char* name;               /* "height_fog": a-z, 0-9 and _, beginning with a letter */
  const char* summary;            /* one sentence */
  brume_role role;
  brume_surface_step step;        /* surface stages */
  const brume_param* params;
  size_t param_count;
  brume_status (*create)(const brume_host*, const brume_value* values, void** self);
  brume_status (*needs)(void* self, const brume_host*, const brume_frame*, brume_needs*);  /* NULL: nothing special */
  brume_status (*publish)(void* self, const brume_host*, const brume_frame*, brume_publisher*);
  brume_status (*run)(void* self, const brume_host*, const brume_tile*);
  void (*destroy)(void* self);
  const char* baseline_name;      /* "Wenzel 2007, listing"; NULL: no baseline */
  brume_baseline_fn baseline;     /* air */
  brume_status (*baseline_run)(void* self, const brume_host*, const brume_tile*);  /* surface, lens: run as the document does it */
  brume_truth_fn truth;           /* surface, lens: optional */
} brume_stage;

typedef struct brume_plugin_info {
  size_t size;
  uint32_t abi;                   /* BRUME_ABI */
  const char* version;            /* the plugin's own */
  const brume_stage* const* stages;
  size_t stage_count;
} brume_plugin_info;

/* What a module exports: extern "C" const brume_plugin_info* brume_plugin(void). */
typedef const brume_plugin_info* (*brume_plugin_fn)(void);

#if defined(__GNUC__)
#define BRUME_EXPORT __attribute__((visibility("default")))
#elif defined(_WIN32)
#define BRUME_EXPORT __declspec(dllexport)
#else
#define BRUME_EXPORT
#endif

#ifdef __cplusplus
}
#endif
#endif
