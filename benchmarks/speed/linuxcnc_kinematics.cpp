#include "speed/linuxcnc_kinematics.h"

#include <dlfcn.h>

#include <cstdarg>
#include <cstddef>
#include <cstdlib>

namespace {

constexpr const char* kModule = "/usr/lib/linuxcnc/modules/xyzac-trt-kins.so";

/// A pin: a place that only the module uses.
int new_pin(void** pin) {
  *pin = std::calloc(1, 16);
  return *pin == nullptr ? -1 : 0;
}

}  // namespace

// What the module finds in rtapi_app when LinuxCNC runs. Pins keep the value 0: no offsets, no tool.
extern "C" {
int hal_init(const char* /*name*/) { return 1; }
int hal_ready(int /*component*/) { return 0; }
int hal_exit(int /*component*/) { return 0; }
void* hal_malloc(long size) { return std::calloc(1, static_cast<std::size_t>(size)); }
int hal_pin_float_newf(int /*direction*/, void** pin, int /*component*/, const char* /*format*/, ...) {
  return new_pin(pin);
}
int hal_pin_bit_newf(int /*direction*/, void** pin, int /*component*/, const char* /*format*/, ...) {
  return new_pin(pin);
}
int hal_pin_s32_newf(int /*direction*/, void** pin, int /*component*/, const char* /*format*/, ...) {
  return new_pin(pin);
}
int hal_pin_u32_newf(int /*direction*/, void** pin, int /*component*/, const char* /*format*/, ...) {
  return new_pin(pin);
}
int hal_pin_float_new(const char* /*name*/, int /*direction*/, void** pin, int /*component*/) { return new_pin(pin); }
int hal_pin_bit_new(const char* /*name*/, int /*direction*/, void** pin, int /*component*/) { return new_pin(pin); }
int hal_pin_s32_new(const char* /*name*/, int /*direction*/, void** pin, int /*component*/) { return new_pin(pin); }
int hal_pin_u32_new(const char* /*name*/, int /*direction*/, void** pin, int /*component*/) { return new_pin(pin); }
void rtapi_print(const char* /*format*/, ...) {}
void rtapi_print_msg(int /*level*/, const char* /*format*/, ...) {}
int rtapi_snprintf(char* text, unsigned long size, const char* /*format*/, ...) {
  if (size > 0) text[0] = 0;
  return 0;
}
}

namespace abbe::benchmarks {

LinuxcncKinematics::LinuxcncKinematics() {
  void* const module = dlopen(kModule, RTLD_NOW | RTLD_LOCAL);
  if (module == nullptr) {
    problem_ = dlerror();
    return;
  }
  const auto find = [&](const char* name) {
    void* const place = dlsym(module, name);
    if (place == nullptr) problem_ = std::string("no ") + name;
    return place;
  };
  int (*start)() = reinterpret_cast<int (*)()>(find("rtapi_app_main"));
  inverse_ = reinterpret_cast<decltype(inverse_)>(find("kinematicsInverse"));
  forward_ = reinterpret_cast<decltype(forward_)>(find("kinematicsForward"));
  if (problem_.empty() && start() != 0) problem_ = "its start failed";
}

}  // namespace abbe::benchmarks
