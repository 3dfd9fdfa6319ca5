/* The interface from C99: this file only has to compile. */
#include "abbe/runtime/abbe_runtime.h"
#include "abbe/runtime/abbe_runtime_states.h"

int joints_at_states(const abbe_runtime* runtime, const double channels[], const double nominal[], double joints[]);

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

int joints_at_states(const abbe_runtime* runtime, const double channels[], const double nominal[], double joints[]) {
  abbe_runtime_states* states = NULL;
  int result = abbe_runtime_states_make(runtime, NULL, &states);
  if (result == ABBE_OK) result = abbe_runtime_states_advance(states, channels, 0.001);
  if (result == ABBE_OK)
    result = abbe_runtime_correct(abbe_runtime_at_states(states), NULL, nominal, NULL, 1.0, joints);
  abbe_runtime_states_free(states);
  return result;
}
