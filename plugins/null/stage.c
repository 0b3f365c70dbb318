/* The smallest complete stage plugin, and the tutorial: read it from top to bottom, then copy it. README.md says how to
 * build it. It needs one header, plain C, and no library.
 *
 * The stage is called "null" because with its parameter at the default it does nothing. Turned up, it fills the world with
 * an even mist.
 */

/* 1. The interface. Installed it is <brume/plugin.h>; inside brume's own tree it lies at the root of src. */
#if defined(__has_include)
#if __has_include(<brume/plugin.h>)
#include <brume/plugin.h>
#else
#include "plugin.h"
#endif
#else
#include <brume/plugin.h>
#endif

#include <stdlib.h>

/* 2. The parameters. Everyone who asks what the stage can be told reads this table: the scene file's parser, which checks
 *    every value against it, `brume stages null`, a node's panel. Nothing is said twice. The order is that of the values in
 *    create (step 4). Colours take three default numbers, plain numbers one. */
static const double kClear[1] = {0};
static const double kGrey[3] = {0.5, 0.5, 0.5};

enum { DENSITY, COLOR, PARAMS };

static const brume_param kParams[PARAMS] = {
    {sizeof(brume_param), "density", BRUME_NUMBER, "1/m", "Extinction of the mist; 0 is clear air.",
     0, 1000, kClear, 1, "", "", 0, NULL, 0},
    {sizeof(brume_param), "color", BRUME_RGB, "", "Colour that thick mist takes, scene-linear.",
     0, 1e6, kGrey, 3, "", "", 0, NULL, 0},
};

/* 3. What one instance remembers. An instance lives for one frame; several frames are worked on at the same time, so nothing
 *    that changes may be global. */
typedef struct Null {
  double density;
  double color[3];
} Null;

/* 4. create: the parameters' values at one frame (keyframes are resolved already, ranges checked). They are valid until the
 *    call returns, so copy them. To fail, say why and return BRUME_FAILED; destroy is then not called. */
static brume_status create(const brume_host* host, const brume_value* values, void** self) {
  Null* null = malloc(sizeof *null);
  (void)host; /* host->fail(host, "why") is for what can go wrong; memory has a status of its own */
  if (!null) return BRUME_NO_MEMORY;
  null->density = values[DENSITY].numbers[0];
  for (int i = 0; i < 3; ++i) null->color[i] = values[COLOR].numbers[i];
  *self = null;
  return BRUME_OK;
}

/* 5. needs: what the stage wants to read, or why it has nothing to do. An idle stage costs nothing at all: it is left out
 *    before the frame is read, and `brume plan` prints the reason. The answer comes with plain values; fill in only what
 *    differs. */
static brume_status needs(void* self, const brume_host* host, const brume_frame* frame,
                          brume_needs* out) {
  const Null* null = self;
  (void)host;
  (void)frame;
  if (null->density == 0) out->idle = "density is 0";
  out->needs_depth = 1; /* how much mist there is depends on how far away things are */
  return BRUME_OK;
}

/* 6. publish: what there is in the world. The stage does not touch pixels; it says that there is a medium, and brume carries
 *    light through all media of all stages together. A medium is a shape, a profile of density, and what it does to light.
 *    Begin with zeros: the fields that you do not know are then right. */
static brume_status publish(void* self, const brume_host* host, const brume_frame* frame,
                            brume_publisher* world) {
  const Null* null = self;
  brume_medium mist = {0};
  (void)host;
  (void)frame;
  mist.size = sizeof mist;
  mist.name = "";
  mist.shape = BRUME_EVERYWHERE;
  mist.profile = BRUME_UNIFORM;
  mist.source = BRUME_SOURCE_COLOR;
  for (int i = 0; i < 3; ++i) {
    mist.extinction[i] = null->density;
    mist.color[i] = null->color[i];
  }
  mist.max_opacity = 1; /* no limit */
  return world->medium(world, &mist);
}

/* 7. destroy: once for every create that succeeded, after the frame. */
static void destroy(void* self) { free(self); }

/* 8. The stage: a name, a sentence, a role, and the functions. An air stage has no run: that is for surface and lens
 *    stages, which change pixels. */
static const brume_stage kNull = {
    sizeof(brume_stage), "null",  "Does nothing, or an even mist: the tutorial for plugin writers.",
    BRUME_AIR,           0,       kParams,
    PARAMS,              create,  needs,
    publish,             NULL,    destroy,
    NULL,                NULL,   NULL,
    NULL,
};

/* 9. The one symbol that a module exports. A plugin may carry several stages. */
static const brume_stage* const kStages[] = {&kNull};
static const brume_plugin_info kInfo = {sizeof(brume_plugin_info), BRUME_ABI, "1.0", kStages, 1};

BRUME_EXPORT const brume_plugin_info* brume_plugin(void);
const brume_plugin_info* brume_plugin(void) { return &kInfo; }
