#pragma once
// What the image_io module (plugins/image_io) offers: every format but EXR, through
// OpenImageIO. Plain C, so that the library never depends on what the module links.
//
// Values pass as they are: integers as 0..1 of their range, no colour curve either way.
// Colour is premultiplied by alpha in memory and as the format has it in the file.

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { BRUME_IMAGE_IO_VERSION = 1 };

typedef struct brume_io_attribute {
  const char *name, *type;  ///< EXR's type names: int, float, string, m44f, v3f ...
  const uint8_t* bytes;
  size_t size;
} brume_io_attribute;

/// One image of a file. Pointers live as long as the handle they came from.
typedef struct brume_io_header {
  int32_t data[4], display[4];  ///< x, y, width, height
  float pixel_aspect;
  int32_t channel_count;
  const char* const* channels;  ///< names in the file's order
  const uint8_t* types;         ///< 1 half, 2 float: the smallest that holds the values
  int32_t attribute_count;
  const brume_io_attribute* attributes;
} brume_io_header;

/// Each function returns 0, or -1 with one line of text in `error` (cut to its size).
typedef struct brume_image_io {
  uint32_t version;
  int (*open)(const char* path, void** handle, char* error, size_t error_size);
  void (*close)(void* handle);
  int32_t (*parts)(void* handle);
  const brume_io_header* (*header)(void* handle, int32_t part);
  /// All pixels of a part into planes[c], top row first, width floats a row.
  int (*read)(void* handle, int32_t part, float* const* planes, char* error,
              size_t error_size);
  /// Writes `path` in the format of `format` (an extension, "png"). Integer formats take
  /// 8 bits for half channels, 16 for float ones where they have them.
  int (*write)(const char* path, const char* format, const brume_io_header* header,
               const float* const* planes, char* error, size_t error_size);
} brume_image_io;

/// The module's one symbol.
typedef const brume_image_io* (*brume_image_io_fn)(void);

#ifdef __cplusplus
}
#endif
