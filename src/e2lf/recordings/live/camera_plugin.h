/* SPDX-License-Identifier: MIT */
/* The C interface of camera plugins: shared libraries that e2lf loads from the files and folders that the environment
   variable E2LF_CAMERA_PLUGINS names, separated by colons. A camera of the plugin "mine" is opened as
   camera://mine/ADDRESS. See examples/camera_plugin.cpp. */
#ifndef E2LF_CAMERA_PLUGIN_H
#define E2LF_CAMERA_PLUGIN_H

#include <stddef.h>
#include <stdint.h>

/* The names are those of C. */
/* NOLINTBEGIN(readability-identifier-naming) */

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface. A plugin of another version is not used. */
#define E2LF_CAMERA_PLUGIN_VERSION 1

/* The size of the buffers for messages of errors, with their final zero. */
#define E2LF_CAMERA_ERROR_SIZE 1024

/* An open camera, whose type the plugin defines. */
typedef struct e2lf_camera e2lf_camera;

typedef enum e2lf_camera_state {
  E2LF_CAMERA_FAILED = -1, /* the message states the reason, e.g. that the camera was unplugged */
  E2LF_CAMERA_ENDED = 0,   /* no bytes follow */
  E2LF_CAMERA_RUNS = 1     /* the buffer contains the new bytes; it is empty if none arrived for a while */
} e2lf_camera_state;

/* Bytes from a camera. The memory belongs to the plugin and is valid until the next call of next() or close(). */
typedef struct e2lf_camera_buffer {
  const uint8_t* bytes;
  size_t size;
  uint64_t lost; /* number of buffers that the camera or its driver lost before this one */
} e2lf_camera_buffer;

/* The functions of a plugin. All names and functions belong to the plugin and must be valid until the process ends.
   Functions that can fail return a negative number and write a message, in UTF-8 and without a line break, to `error`,
   which has E2LF_CAMERA_ERROR_SIZE bytes. Functions must not throw. Texts that e2lf passes are valid during the call.
   Functions marked as optional may be NULL if the camera does not support them. */
typedef struct e2lf_camera_functions {
  uint32_t version;        /* E2LF_CAMERA_PLUGIN_VERSION */
  const char* name;        /* lower-case letters, digits, '-' and '_' */
  const char* description; /* one line: the supported cameras, and the meaning of ADDRESS */

  /* Calls add(list, address) for each connected camera. Optional. */
  int (*list)(void (*add)(void* list, const char* address), void* list, char* error);

  /* Opens a camera; an empty address denotes the first one. Returns NULL on failure. The result is passed to close()
     once and not used afterwards. */
  e2lf_camera* (*open)(const char* address, char* error);
  void (*close)(e2lf_camera* camera);

  /* Settings, called between open() and start(). */

  /* Enables the trigger inputs with these names, or all of them if `count` is 0. Optional. */
  int (*triggers_on)(e2lf_camera* camera, const char* const* inputs, size_t count, char* error);
  /* Applies the text of a .bias file. Optional. */
  int (*load_biases)(e2lf_camera* camera, const char* text, char* error);
  /* Returns the biases as the text of a .bias file, which belongs to the plugin and is valid until the next call of a
     function of this camera; NULL on failure. Called after start(). Optional. */
  const char* (*save_biases)(e2lf_camera* camera, char* error);
  /* Sets "max-event-rate" (events per second, 0 = no limit), "roi" ("X,Y,WIDTH,HEIGHT", several with spaces between
     them), "encoding" ("evt2", "evt2.1", "evt3") or "sensor-filters" ("off": those that drop events). Optional. */
  int (*set)(e2lf_camera* camera, const char* name, const char* value, char* error);

  /* Starts the delivery of events. */
  int (*start)(e2lf_camera* camera, char* error);
  /* Waits for up to about 100 ms for the next bytes. The bytes of all buffers are a recording in Prophesee's RAW
     format: a header ("% evt 3.0", "% geometry 1280x720", "% end"), then event words. After stop(), it returns the
     bytes that had arrived by then, and then E2LF_CAMERA_ENDED. Called by one thread. */
  e2lf_camera_state (*next)(e2lf_camera* camera, e2lf_camera_buffer* buffer, char* error);
  /* Makes next() end soon. Called by another thread than next(). */
  void (*stop)(e2lf_camera* camera);
} e2lf_camera_functions;

/* The only function that a plugin exports. */
typedef const e2lf_camera_functions* (*e2lf_camera_plugin_function)(void);
#define E2LF_CAMERA_PLUGIN_FUNCTION "e2lf_camera_plugin"
#if defined(__GNUC__)
__attribute__((visibility("default")))
#endif
const e2lf_camera_functions*
e2lf_camera_plugin(void);

#ifdef __cplusplus
}
#endif

/* NOLINTEND(readability-identifier-naming) */

#endif
