/* The interface from C99: this file only has to compile. */
#include "abbe/runtime/abbe_runtime.h"

int joints_of(const void* bytes, size_t size, const double point[3], const double words[], double joints[]);

int joints_of(const void* bytes, size_t size, const double point[3], const double words[], double joints[]) {
  abbe_runtime* runtime = NULL;
  abbe_runtime_state state;
  char text[ABBE_RUNTIME_TEXT];
  int result = abbe_runtime_load(bytes, size, text, sizeof text, &runtime);
  abbe_runtime_start(&state);
  if (result == ABBE_OK) result = abbe_runtime_inverse(runtime, &state, point, words, NULL, 1.0, joints);
  abbe_runtime_free(runtime);
  return result;
}
