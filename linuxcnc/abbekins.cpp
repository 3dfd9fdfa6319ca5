// SPDX-License-Identifier: GPL-2.0-or-later
//
// Kinematics of any machine file for LinuxCNC, with its errors compensated: a shim around abbe/runtime/abbe_runtime.h.
// See README.md in this folder. Files are read in rtapi_app_main; nothing else reads, allocates or locks.

#include <cctype>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <initializer_list>

#include "emcpos.h"  // C++ of its own: before and outside of extern "C"
extern "C" {
#include "hal.h"
#include "kinematics.h"
#include "rtapi.h"
#include "rtapi_app.h"
}

#include "abbe/runtime/abbe_runtime.h"
#include "abbekins_states.h"

extern "C" {
MODULE_LICENSE("GPL");
static char no_text[] = "";
static char* model = no_text;
RTAPI_MP_STRING(model, "absolute path of a frozen compensation (*.abbec)");
static char* coordinates = no_text;
RTAPI_MP_STRING(coordinates, "names of the axes in the order of joints, such as XYZAC or X,Y,Z,C1,A");
static char* states = no_text;
RTAPI_MP_STRING(states, "absolute path of the states that keep-states stores");
static int states_hours = 24;
RTAPI_MP_INT(states_hours, "stored states that are older are not used");
static char default_space[] = "tool";
static char* space = default_space;
RTAPI_MP_STRING(space, "tool: world coordinates are those of the tool in the workpiece; axes: they are axis positions");
}

namespace abbekins {

void complain(const char* what, const char* detail) {
  rtapi_print_msg(RTAPI_MSG_ERR, ABBEKINS_NAME ": %s%s%s\n", what, detail[0] != 0 ? ": " : "", detail);
}

unsigned char* read_file(const char* path, size_t& size) {
  std::FILE* const file = std::fopen(path, "rb");
  if (file == nullptr) return nullptr;
  unsigned char* bytes = nullptr;
  size = 0;
  if (std::fseek(file, 0, SEEK_END) == 0) {
    const long length = std::ftell(file);
    if (length > 0 && length < 64L << 20 && std::fseek(file, 0, SEEK_SET) == 0) {
      bytes = static_cast<unsigned char*>(std::malloc(static_cast<size_t>(length)));
      if (bytes != nullptr) size = std::fread(bytes, 1, static_cast<size_t>(length), file);
    }
  }
  std::fclose(file);
  return bytes;
}

}  // namespace abbekins

namespace {

using abbekins::complain;
using abbekins::read_file;

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kLongestPause = 0.005;  // s; after a longer one the ramp goes on as if it had been this long: no jump

/// What is visible in HAL. Lengths mm, angles degrees.
struct Pins {
  hal_bit_t* enable;                           // in: compensate
  hal_float_t* enabled;                        // out: part of the errors that is compensated, 0 to 1
  hal_float_t* offset[3];                      // in: motion.tooloffset.x, .y, .z
  hal_float_t* correction[ABBE_RUNTIME_AXES];  // out, of each joint
  hal_float_t* largest;                        // out: largest correction of a linear joint so far
  hal_float_t* uncertainty;                    // out: standard uncertainty of the tool point's correction, um; or -1
  hal_s32_t* status;                           // out: result of the last call, see abbe_runtime.h
  hal_bit_t* outside_map;                      // out: errors are not known there and stay those of the edge
  hal_bit_t* outside_tool;                     // out: the tool is longer or shorter than the file was checked for
  hal_bit_t* turn_limited;                     // out: near a singularity
  hal_float_t ramp_seconds;                    // parameter: duration of the change from 0 to 1 and back
};

struct Module {
  int component = -1;
  Pins* pins = nullptr;
  abbe_runtime* runtime = nullptr;
  const abbe_runtime* present = nullptr;  // the same, at the present states
  abbe_runtime_state inverse_state, forward_state;
  int axes = 0;
  bool tool_space = true;
  bool rotary[ABBE_RUNTIME_AXES] = {};
  bool solved[ABBE_RUNTIME_AXES] = {};
  double EmcPose::*word[ABBE_RUNTIME_AXES] = {};  // of x, y, z: null
  int tran[ABBE_RUNTIME_AXES] = {};               // 0 1 2: x y z; -1: see word
  int axis_of_joint[ABBE_RUNTIME_AXES] = {};
  double ramp = 0;       // 0 to 1, linear in time
  double part = 0;       // of the errors that is compensated now
  bool refused = false;  // the last pose
  long long last_time = 0;
};
Module module;

double& world_value(EmcPose& pose, int axis) {
  if (module.tran[axis] == 0) return pose.tran.x;
  if (module.tran[axis] == 1) return pose.tran.y;
  if (module.tran[axis] == 2) return pose.tran.z;
  return pose.*module.word[axis];
}

/// The part of the errors that is compensated follows the pin within the stated time, with a smooth start and end so
/// that no joint is asked for a sudden speed. To be called once per servo cycle, because a longer pause counts once per
/// call.
void advance_ramp() {
  const long long now = rtapi_get_time();
  double passed = 1e-9 * static_cast<double>(now - module.last_time);
  if (module.last_time == 0 || passed < 0) passed = 0;
  if (passed > kLongestPause) passed = kLongestPause;
  module.last_time = now;
  const double seconds = module.pins->ramp_seconds;
  const double step = seconds > 1e-3 ? passed / seconds : 1;
  module.ramp += *module.pins->enable ? step : -step;
  if (!(module.ramp > 0)) module.ramp = 0;
  if (module.ramp > 1) module.ramp = 1;
  module.part = module.ramp * module.ramp * (3 - 2 * module.ramp);
  *module.pins->enabled = module.part;
}

/// Tool length from HAL: the offset as LinuxCNC adds it to world coordinates, and the functional point from the gauge
/// point.
void current_tool(double offset[3], double tool[3]) {
  for (int k = 0; k < 3; ++k) offset[k] = *module.pins->offset[k];
  abbe_runtime_tool_of_offset(module.runtime, offset, tool);
}

void report(int result, const abbe_runtime_state& state) {
  Pins& pins = *module.pins;
  *pins.status = result;
  *pins.outside_map = result >= 0 && (result & ABBE_OUTSIDE_MAP) != 0;
  *pins.outside_tool = result >= 0 && (result & ABBE_OUTSIDE_TOOL) != 0;
  *pins.turn_limited = result >= 0 && (result & ABBE_RESULT_MASK) == ABBE_TURN_LIMITED;
  if (result < 0) return;
  for (int i = 0; i < module.axes; ++i) {
    *pins.correction[i] = state.correction[i] / (module.rotary[i] ? kDegree : 1);
    if (!module.rotary[i] && std::fabs(state.correction[i]) > *pins.largest) {
      *pins.largest = std::fabs(state.correction[i]);
    }
  }
}

/// Standard uncertainty of the correction that was computed last; -1 if the file has none. It is a matter of nominal
/// joints, so it is the same however much of the correction is enabled.
void report_uncertainty(const double* joints, const double* tool) {
  double nominal[ABBE_RUNTIME_AXES], uncertainty = 0;
  for (int i = 0; i < module.axes; ++i) nominal[i] = joints[i] - module.inverse_state.correction[i];
  const int result = abbe_runtime_uncertainty(module.runtime, nominal, tool, &uncertainty);
  *module.pins->uncertainty = result >= 0 ? 1e3 * uncertainty : -1;
}

int load_model() {
  if (model[0] == 0) {
    complain("no compensation given", "KINEMATICS = " ABBEKINS_NAME " model=/absolute/path.abbec");
    return -EINVAL;
  }
  size_t size = 0;
  unsigned char* const bytes = read_file(model, size);
  if (bytes == nullptr) {
    complain("cannot read", model);
    return -ENOENT;
  }
  char text[160];
  const int result = abbe_runtime_load(bytes, size, text, sizeof text, &module.runtime);
  std::free(bytes);
  if (result == ABBE_OK) return 0;
  complain(model, text);
  return -EINVAL;
}

/// "C2" of an axis.
void name_of(const abbe_runtime_axis& axis, char name[8]) {
  if (axis.number > 0) {
    std::snprintf(name, 8, "%c%d", axis.letter, axis.number % 100);
  } else {
    std::snprintf(name, 8, "%c", axis.letter);
  }
}

/// Which number of EmcPose belongs to an axis: that of its letter, or the next free one of its kind.
bool choose_word(int axis, char letter, bool used[9]) {
  static const char letters[] = "XYZABCUVW";
  static double EmcPose::*const words[9] = {nullptr,     nullptr,     nullptr,     &EmcPose::a, &EmcPose::b,
                                            &EmcPose::c, &EmcPose::u, &EmcPose::v, &EmcPose::w};
  const bool rotary = module.rotary[axis];
  int chosen = -1;
  for (int k = 0; k < 9; ++k) {
    // In tool space x, y and z are the point of the tool.
    const bool fits = rotary ? k >= 3 && k < 6 : k >= 6 || (k < 3 && !module.tool_space);
    if (!fits || used[k]) continue;
    if (letters[k] == letter) chosen = k;
  }
  for (int k = 8; chosen < 0 && k >= 0; --k) {
    const bool fits = rotary ? k >= 3 && k < 6 : k >= 6;
    if (fits && !used[k]) chosen = k;
  }
  if (chosen < 0) return false;
  used[chosen] = true;
  module.word[axis] = words[chosen];
  module.tran[axis] = chosen < 3 ? chosen : -1;
  return true;
}

/// Joints in the order of `coordinates`, or X Y Z A B C U V W and then as in the chain.
bool order_joints(abbe_runtime_axis const* axes) {
  bool taken[ABBE_RUNTIME_AXES] = {};
  int joints = 0;
  const auto take = [&](const char* wanted) {
    for (int i = 0; i < module.axes; ++i) {
      char name[8];
      name_of(axes[i], name);
      if (taken[i] || std::strcmp(name, wanted) != 0) continue;
      taken[i] = true;
      module.axis_of_joint[joints++] = i;
      return true;
    }
    return false;
  };
  if (coordinates[0] == 0) {
    for (const char letter : {'X', 'Y', 'Z', 'A', 'B', 'C', 'U', 'V', 'W'}) {
      const char wanted[2] = {letter, 0};
      take(wanted);
    }
    for (int i = 0; i < module.axes; ++i) {
      char name[8];
      name_of(axes[i], name);
      if (!taken[i]) take(name);
    }
    return true;
  }
  for (const char* at = coordinates; *at != 0;) {
    if (*at == ',' || *at == ' ') {
      ++at;
      continue;
    }
    char wanted[8] = {*at++, 0};
    for (int length = 1; length < 3 && *at >= '0' && *at <= '9'; ++length) wanted[length] = *at++;
    wanted[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(wanted[0])));
    if (!take(wanted)) {
      complain("coordinates: no such axis, or twice", wanted);
      return false;
    }
  }
  if (joints == module.axes) return true;
  complain("coordinates: every axis of the machine must be named", coordinates);
  return false;
}

int prepare_axes() {
  abbe_runtime_information about;
  abbe_runtime_describe(module.runtime, &about);
  module.axes = about.axes;
  if (std::strcmp(space, "tool") != 0 && std::strcmp(space, "axes") != 0) {
    complain("space must be tool or axes", space);
    return -EINVAL;
  }
  module.tool_space = about.tool_centre != 0 && std::strcmp(space, "tool") == 0;
  abbe_runtime_axis axes[ABBE_RUNTIME_AXES];
  bool used[9] = {};
  for (int i = 0; i < module.axes; ++i) {
    abbe_runtime_describe_axis(module.runtime, i, &axes[i]);
    module.rotary[i] = axes[i].rotary != 0;
    module.solved[i] = module.tool_space && axes[i].solved != 0;
  }
  // Axes with a letter of their own first: what is left is for the others.
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < module.axes; ++i) {
      const bool plain = axes[i].number == 0;
      if (module.solved[i] || plain != (pass == 0)) continue;
      if (!choose_word(i, axes[i].letter, used)) {
        complain("more axes than LinuxCNC has letters for", model);
        return -EINVAL;
      }
    }
  }
  if (!order_joints(axes)) return -EINVAL;
  rtapi_print_msg(RTAPI_MSG_INFO, ABBEKINS_NAME ": %s, largest correction %.1f um, %s space\n", about.machine,
                  1e3 * about.largest_correction_mm, module.tool_space ? "tool" : "axis");
  return 0;
}

int make_pins() {
  module.pins = static_cast<Pins*>(hal_malloc(sizeof(Pins)));
  if (module.pins == nullptr) return -ENOMEM;
  Pins& pins = *module.pins;
  const int id = module.component;
  int failed = hal_pin_bit_newf(HAL_IN, &pins.enable, id, ABBEKINS_NAME ".enable");
  failed |= hal_pin_float_newf(HAL_OUT, &pins.enabled, id, ABBEKINS_NAME ".enabled");
  for (int k = 0; k < 3; ++k)
    failed |= hal_pin_float_newf(HAL_IN, &pins.offset[k], id, ABBEKINS_NAME ".tooloffset-%c", "xyz"[k]);
  for (int i = 0; i < module.axes; ++i) {
    abbe_runtime_axis axis;
    char name[8];
    abbe_runtime_describe_axis(module.runtime, i, &axis);
    name_of(axis, name);
    for (char* at = name; *at != 0; ++at) *at = static_cast<char>(std::tolower(static_cast<unsigned char>(*at)));
    failed |= hal_pin_float_newf(HAL_OUT, &pins.correction[i], id, ABBEKINS_NAME ".correction-%s", name);
  }
  failed |= hal_pin_float_newf(HAL_OUT, &pins.largest, id, ABBEKINS_NAME ".largest-correction");
  failed |= hal_pin_float_newf(HAL_OUT, &pins.uncertainty, id, ABBEKINS_NAME ".uncertainty-um");
  failed |= hal_pin_s32_newf(HAL_OUT, &pins.status, id, ABBEKINS_NAME ".status");
  failed |= hal_pin_bit_newf(HAL_OUT, &pins.outside_map, id, ABBEKINS_NAME ".outside-map");
  failed |= hal_pin_bit_newf(HAL_OUT, &pins.outside_tool, id, ABBEKINS_NAME ".outside-tool");
  failed |= hal_pin_bit_newf(HAL_OUT, &pins.turn_limited, id, ABBEKINS_NAME ".turn-limited");
  failed |= hal_param_float_newf(HAL_RW, &pins.ramp_seconds, id, ABBEKINS_NAME ".ramp-seconds");
  pins.ramp_seconds = 1;
  return failed == 0 ? 0 : -ENOMEM;
}

}  // namespace

extern "C" {

int kinematicsForward(const double* joints, EmcPose* world, const KINEMATICS_FORWARD_FLAGS* /*forward*/,
                      KINEMATICS_INVERSE_FLAGS* /*inverse*/) {
  double q[ABBE_RUNTIME_AXES] = {}, words[ABBE_RUNTIME_AXES] = {}, offset[3], tool[3], point[3];
  for (int j = 0; j < module.axes; ++j) {
    const int axis = module.axis_of_joint[j];
    q[axis] = joints[j] * (module.rotary[axis] ? kDegree : 1);
  }
  // LinuxCNC calls this once per servo cycle as soon as all joints are homed, before the inverse.
  advance_ramp();
  abbekins::advance_states();
  current_tool(offset, tool);
  const int result =
      module.tool_space
          ? abbe_runtime_forward(module.present, &module.forward_state, q, tool, module.part, point, words)
          : abbe_runtime_uncorrect(module.present, &module.forward_state, q, tool, module.part, words);
  report(result, module.forward_state);
  if (result < 0) return -1;
  for (int i = 0; i < module.axes; ++i) {
    if (!module.solved[i]) world_value(*world, i) = words[i] / (module.rotary[i] ? kDegree : 1);
  }
  if (module.tool_space) {
    world->tran.x = point[0] + offset[0];
    world->tran.y = point[1] + offset[1];
    world->tran.z = point[2] + offset[2];
  }
  return 0;
}

int kinematicsInverse(const EmcPose* world, double* joints, const KINEMATICS_INVERSE_FLAGS* /*inverse*/,
                      KINEMATICS_FORWARD_FLAGS* /*forward*/) {
  double q[ABBE_RUNTIME_AXES] = {}, words[ABBE_RUNTIME_AXES] = {}, offset[3], tool[3];
  EmcPose pose = *world;
  for (int i = 0; i < module.axes; ++i) {
    if (!module.solved[i]) words[i] = world_value(pose, i) * (module.rotary[i] ? kDegree : 1);
  }
  current_tool(offset, tool);
  const double point[3] = {pose.tran.x - offset[0], pose.tran.y - offset[1], pose.tran.z - offset[2]};
  const int result =
      module.tool_space
          ? abbe_runtime_inverse(module.present, &module.inverse_state, point, words, tool, module.part, q)
          : abbe_runtime_correct(module.present, &module.inverse_state, words, tool, module.part, q);
  report(result, module.inverse_state);
  if (result < 0) {
    // LinuxCNC stops then and says no more than that kinematics failed; soon the forward's result is in the pin.
    if (!module.refused) complain("no joints for a pose", abbe_runtime_text(result));
    module.refused = true;
    return -1;
  }
  module.refused = false;
  report_uncertainty(q, tool);
  for (int j = 0; j < module.axes; ++j) {
    const int axis = module.axis_of_joint[j];
    joints[j] = q[axis] / (module.rotary[axis] ? kDegree : 1);
  }
  return 0;
}

KINEMATICS_TYPE kinematicsType() { return KINEMATICS_BOTH; }
KINS_NOT_SWITCHABLE
EXPORT_SYMBOL(kinematicsType);
EXPORT_SYMBOL(kinematicsForward);
EXPORT_SYMBOL(kinematicsInverse);

int rtapi_app_main() {
  abbe_runtime_start(&module.inverse_state);
  abbe_runtime_start(&module.forward_state);
  module.component = hal_init(ABBEKINS_NAME);
  if (module.component < 0) return module.component;
  int result = load_model();
  if (result == 0) result = prepare_axes();
  if (result == 0) result = make_pins();
  if (result == 0) result = abbekins::make_states(module.component, module.runtime, states, states_hours);
  module.present = abbekins::at_states(module.runtime);
  if (result == 0) result = hal_ready(module.component);
  if (result != 0) {
    hal_exit(module.component);
    abbekins::free_states();
    abbe_runtime_free(module.runtime);
    module.runtime = nullptr;
  }
  return result;
}

void rtapi_app_exit() {
  hal_exit(module.component);
  abbekins::free_states();
  abbe_runtime_free(module.runtime);
  module.runtime = nullptr;
}

}  // extern "C"
