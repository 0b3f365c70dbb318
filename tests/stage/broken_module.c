/* A good plugin with one thing broken, chosen by a definition when it is compiled: what can be wrong with a module before any
 * of its functions is called. Its stage carries the module's name (STAGE), so that the registry finds it by that. */
#include "plugin.h"

#include <stddef.h>
#include <stdint.h>

static brume_status create(const brume_host* h, const brume_value* v, void** self) {
  (void)h, (void)v;
  *self = NULL;
  return BRUME_OK;
}
static brume_status publish(void* s, const brume_host* h, const brume_frame* f, brume_publisher* p) {
  (void)s, (void)h, (void)f, (void)p;
  return BRUME_OK;
}
static void destroy(void* self) { (void)self; }

static const double kOne[3] = {1, 1, 1};
static const double kRising[4] = {1, 0.1, 2, 0.2}; /* a knob whose error rises */

/* A parameter as a newer interface would have it: one field more at the end. */
typedef struct newer_param {
  brume_param known;
  double more;
} newer_param;

static const newer_param kParams[2] = {
    {{sizeof(newer_param),
#if defined(PARAM_RESERVED)
      "mix",
#elif defined(PARAM_NAME)
      "Not a name",
#else
      "amount",
#endif
#if defined(PARAM_KIND)
      (brume_kind)77,
#else
      BRUME_NUMBER,
#endif
      "m", "How much.",
#if defined(PARAM_RANGE)
      10, 0,
#else
      0, 10,
#endif
      kOne,
#if defined(PARAM_COUNT)
      3,
#else
      1,
#endif
      "", "",
#if defined(PARAM_CURVE)
      BRUME_PARAM_KNOB, kRising, 4},
#else
      0, NULL, 0},
#endif
     7},
    {{
#if defined(PARAM_SIZE)
         8,
#else
         sizeof(newer_param),
#endif
#if defined(PARAM_TWICE)
         "amount",
#else
         "other",
#endif
         BRUME_NUMBER, "", "", 0,
#if defined(PARAM_DEFAULT)
         0.5,
#else
         1,
#endif
         kOne, 1, "", "", 0, NULL, 0},
     7},
};

/* So has its stage. */
typedef struct newer_stage {
  brume_stage known;
  void (*more)(void);
} newer_stage;

static const newer_stage kStage = {
    {
#if defined(SMALL_STAGE)
        16,
#elif defined(OLDER)
        offsetof(brume_stage, baseline_name), /* as its ABI 1 was first published */
#else
        sizeof(newer_stage),
#endif
#if defined(OTHER_STAGE)
        "another",
#elif defined(STAGE_NAME)
        "../../etc/passwd",
#else
        STAGE,
#endif
        "Broken on purpose.",
#if defined(STAGE_ROLE)
        (brume_role)9,
#elif defined(NO_RUN)
        BRUME_LENS,
#else
        BRUME_AIR,
#endif
        0, (const brume_param*)kParams, 2,
#if defined(NO_CREATE)
        NULL,
#else
        create,
#endif
        NULL,
#if defined(NO_PUBLISH)
        NULL,
#else
        publish,
#endif
        NULL, destroy, "Nobody 2007",
        (brume_baseline_fn)0, NULL, NULL},
    NULL};

static const brume_stage* const kStages[] = {
#if defined(NULL_STAGE)
    NULL,
#else
    &kStage.known,
#endif
    &kStage.known};

static const brume_plugin_info kInfo = {
#if defined(SMALL_INFO)
    24,
#elif defined(EMPTY_INFO)
    0,
#else
    sizeof(brume_plugin_info),
#endif
#if defined(WRONG_ABI)
    BRUME_ABI + 41,
#else
    BRUME_ABI,
#endif
    "0.1",
#if defined(NO_LIST)
    NULL,
#else
    kStages,
#endif
#if defined(NO_STAGES)
    0
#elif defined(STAGE_TWICE)
    2
#else
    1
#endif
};

#if defined(NO_SYMBOL)
BRUME_EXPORT const brume_plugin_info* brume_plugins(void) {
#else
BRUME_EXPORT const brume_plugin_info* brume_plugin(void) {
#endif
#if defined(NULL_INFO)
  return (void)&kInfo, NULL;
#else
  return &kInfo;
#endif
}
