#include "abbe/runtime/frozen_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <new>

#include "abbe/runtime/frozen_couplings.h"
#include "abbe/runtime/frozen_layout.h"
#include "abbe/runtime/frozen_pose.h"
#include "abbe/runtime/frozen_states.h"
#include "abbe/runtime/frozen_values.h"

namespace abbe {

static_assert(ABBE_RUNTIME_FORMAT == frozen::kFormatWithStates + frozen::kFormatsForCouplings);

namespace frozen {
namespace {

constexpr std::array<std::uint64_t, 256> make_table() {
  std::array<std::uint64_t, 256> table{};
  for (std::uint64_t i = 0; i < 256; ++i) {
    std::uint64_t value = i;
    for (int bit = 0; bit < 8; ++bit) value = (value & 1U) != 0 ? (value >> 1U) ^ 0xc96c5795d7870f42ULL : value >> 1U;
    table[i] = value;
  }
  return table;
}
constexpr std::array<std::uint64_t, 256> kTable = make_table();

std::uint64_t add_byte(std::uint64_t value, unsigned char byte) {
  return kTable[(value ^ byte) & 0xffU] ^ (value >> 8U);
}

}  // namespace

std::uint64_t checksum(const unsigned char* bytes, std::size_t size) {
  std::uint64_t value = ~std::uint64_t{0};
  for (std::size_t i = 0; i < size; ++i) {
    value = add_byte(value, i >= kChecksumAt && i < kChecksumAt + 8 ? 0 : bytes[i]);
  }
  return ~value;
}

std::uint64_t crc(const unsigned char* bytes, std::size_t size) {
  std::uint64_t value = ~std::uint64_t{0};
  for (std::size_t i = 0; i < size; ++i) value = add_byte(value, bytes[i]);
  return ~value;
}

}  // namespace frozen

namespace {

FrozenChoice read_choice(Values& values, std::size_t axes, std::string_view field) {
  FrozenChoice choice;
  choice.count = values.whole(3, field);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t axis = values.whole(kFrozenAxes, field);
    if (k >= choice.count) continue;
    values.require(axis < axes, field);
    choice.axis[k] = axis < axes ? axis : 0;
    for (std::size_t other = 0; other < k; ++other) values.require(choice.axis[other] != axis, field);
  }
  return choice;
}

void read_machine(Values& values, abbe_runtime& m, std::size_t& groups) {
  m.axes = values.whole(kFrozenAxes, "number of axes");
  values.require(m.axes > 0, "number of axes");
  m.solved = read_choice(values, m.axes, "axes of the point");
  m.turning = read_choice(values, m.axes, "axes of the orientation");
  m.reaching = read_choice(values, m.axes, "axes that correct the point");
  values.require(m.turning.count <= 2, "axes of the orientation");
  values.require(m.solved.count == 0 || m.solved.count == 3, "axes of the point");
  m.largest_turn = values.number(1e-9, 1, "largest turn");
  m.largest_shift = values.number(1e-6, 1000, "largest shift");
  m.tool_reference = values.triple("tool reference");
  m.tool = values.triple("tool");
  m.tool_error = values.triple("tool offset error");
  m.tool_direction = values.unit("tool direction");
  m.tool_length_min = values.length("tool length");
  m.tool_length_max = values.length("tool length");
  m.world_zero = values.triple("origin of the world");
  double r[9];
  for (double& element : r) element = values.number(-1.1, 1.1, "workpiece frame");
  // Row-major to columns.
  m.workpiece_from_bed = {{r[0], r[3], r[6]}, {r[1], r[4], r[7]}, {r[2], r[5], r[8]}};
  const Turned& w = m.workpiece_from_bed;
  const Triple third = cross(w.x, w.y) - w.z;
  values.require(std::abs(dot(w.x, w.x) - 1) < 1e-9 && std::abs(dot(w.y, w.y) - 1) < 1e-9 &&
                     std::abs(dot(w.x, w.y)) < 1e-9 && dot(third, third) < 1e-16,
                 "workpiece frame");
  m.workpiece_from_bed_shift = values.triple("workpiece frame");
  abbe_runtime_information& about = m.information;
  about.largest_correction_mm = values.number(0, frozen::kLongest, "largest correction");
  about.largest_correction_rad = values.number(0, frozen::kLongest, "largest correction");
  about.accuracy_mm = values.number(0, frozen::kLongest, "accuracy");
  about.accuracy_rad = values.number(0, frozen::kLongest, "accuracy");
  about.worst_iterations = static_cast<int>(values.whole(ABBE_RUNTIME_ITERATIONS, "iterations"));
  groups = values.whole(frozen::kMostGroups, "number of groups");
}

void read_axis(Values& values, FrozenAxis& axis) {
  axis.rotary = values.flag("kind of an axis");
  axis.tool_side = values.flag("side of an axis");
  axis.sense = values.flag("prime of an axis") ? -1 : 1;
  axis.chain_sign = axis.tool_side ? axis.sense : -axis.sense;
  axis.error_first = values.flag("order of errors");
  axis.endless = values.flag("travel");
  const std::size_t letter = values.whole('Z', "letter of an axis");
  values.require(letter >= 'A', "letter of an axis");
  axis.letter = static_cast<char>(values.ok() ? letter : 'X');
  axis.number = static_cast<int>(values.whole(99, "number of an axis"));
  axis.direction = values.unit("direction of an axis");
  axis.point = values.triple("point of an axis");
  axis.actual_direction = values.unit("direction of an axis with errors");
  axis.actual_centre = values.triple("centre of an axis with errors");
  // Errors are small; half way between two nearly opposite directions there would be none.
  values.require(dot(axis.direction, axis.actual_direction) > 0.9, "direction of an axis with errors");
  axis.zero_position = values.number(-1000, 1000, "zero position of an axis");
  axis.zero_turn = turn_of(axis.zero_position);
  axis.map_min = values.length("range of the errors");
  axis.map_max = values.length("range of the errors");
  axis.travel_min = values.length("travel");
  axis.travel_max = values.length("travel");
}

void read_parameters(Values& values, FrozenGroup& group, double first, double second) {
  switch (group.kind) {
    case FrozenGroup::Kind::chebyshev:
      values.require(second > first, "range of a group");
      if (!values.ok()) return;
      group.scale = 2 / (second - first);
      group.shift = -(second + first) / (second - first);
      values.require(!group.everywhere && std::abs(group.scale * group.lowest + group.shift) <= frozen::kMostBeyond &&
                         std::abs(group.scale * group.highest + group.shift) <= frozen::kMostBeyond,
                     "range of a group");
      return;
    case FrozenGroup::Kind::fourier:
      values.require(first >= 1e-3 && group.functions % 2 == 1, "period of a group");
      if (values.ok()) group.scale = kWholeTurn / first;
      group.period = first;
      return;
    case FrozenGroup::Kind::piecewise_cubic:
      values.require(first == 0 || first >= 1e-3, "period of a group");
      group.period = first;
      values.require(group.everywhere == (first > 0), "period of a group");
      return;
  }
}

void read_nodes(Values& values, FrozenGroup& group, double* nodes) {
  group.nodes = nodes;
  for (std::size_t k = 0; k <= group.functions; ++k) {
    nodes[k] = values.length("nodes of a group");
    if (k > 0) values.require(nodes[k] - nodes[k - 1] >= 1e-6, "nodes of a group");
  }
  if (!values.ok()) return;
  group.origin = nodes[0];
  const double last = nodes[group.functions], spacing = (last - nodes[0]) / static_cast<double>(group.functions);
  if (group.everywhere) {
    values.require(std::abs(last - nodes[0] - group.period) <= 1e-9 * group.period, "period of a group");
  } else {
    const double beyond = 0.1 * spacing;
    values.require(group.lowest >= nodes[0] - beyond && group.highest <= last + beyond, "range of a group");
  }
  bool even = true;
  for (std::size_t k = 0; k <= group.functions; ++k)
    even = even && std::abs(nodes[k] - (nodes[0] + spacing * static_cast<double>(k))) <= 1e-6 * spacing;
  group.per_spacing = even ? 1 / spacing : 0;
}

}  // namespace

void read_group(Values& values, const abbe_runtime& m, FrozenGroup& group, std::size_t& axis, double*& room) {
  axis = values.whole(m.axes - 1, "axis of a group");
  group.kind = static_cast<FrozenGroup::Kind>(values.whole(2, "kind of a group"));
  const bool piecewise = group.kind == FrozenGroup::Kind::piecewise_cubic;
  group.functions = values.whole(piecewise ? frozen::kMostIntervals : frozen::kMostFunctions, "size of a group");
  values.require(group.functions > 0, "size of a group");
  group.everywhere = values.flag("range of a group");
  group.lowest = values.length("range of a group");
  group.highest = values.length("range of a group");
  values.require(group.highest >= group.lowest, "range of a group");
  const double first = values.number(-frozen::kLongest, frozen::kLongest, "range of a group");
  const double second = values.number(-frozen::kLongest, frozen::kLongest, "range of a group");
  read_parameters(values, group, first, second);
  const std::size_t nodes = piecewise ? group.functions + 1 : 0, all = group_rows(group);
  if (!values.ok() || values.left() < nodes + 6 * all) {
    values.fail("size of a group");
    return;
  }
  if (piecewise) {
    read_nodes(values, group, room);
    room += nodes;
  }
  // As the commands do, the first harmonic of a whole turn.
  constexpr double kLastDigits = 2 * std::numeric_limits<double>::epsilon();
  const double periods = group.period > 0 ? std::round(kWholeTurn / group.period) : 0;
  group.whole_turns = group.everywhere && m.axis[axis].rotary && periods >= 1 &&
                      std::abs(group.period * periods - kWholeTurn) <= kLastDigits * kWholeTurn;
  group.same_turn = group.kind == FrozenGroup::Kind::fourier && group.whole_turns && periods == 1;
  group.coefficients = room;
  for (std::size_t k = 0; k < all; ++k, room += 6) {
    for (std::size_t c = 0; c < 6; ++c)
      room[c] = values.number(-frozen::kLargestError, frozen::kLargestError, "coefficients of a group");
  }
}

namespace {

void read_uncertainty(Values& values, abbe_runtime& m, double* room) {
  FrozenUncertainty& u = m.uncertainty;
  constexpr std::string_view kField = "uncertainty of the correction";
  u.dimensions = values.whole(FrozenUncertainty::kMostDimensions, kField);
  m.information.has_uncertainty = u.dimensions > 0 ? 1 : 0;
  m.information.largest_uncertainty_mm = values.number(0, frozen::kLongest, kField);
  m.information.mean_uncertainty_mm = values.number(0, frozen::kLongest, kField);
  m.information.uncertainty_lattice_mm = values.number(0, frozen::kLongest, kField);
  std::size_t nodes = 1;
  for (std::size_t k = 0; values.ok() && k < u.dimensions; ++k) {
    FrozenUncertainty::Dimension& d = u.dimension[k];
    d.axis = values.whole(FrozenUncertainty::kToolLength, kField);
    d.nodes = values.whole(FrozenUncertainty::kMostNodes / nodes, kField);
    d.from = values.length(kField);
    d.to = values.length(kField);
    d.is_periodic = values.flag(kField);
    values.require(d.axis < m.axes || d.axis == FrozenUncertainty::kToolLength, kField);
    values.require(d.nodes >= 2 && d.to - d.from >= 1e-6, kField);
    nodes *= d.nodes > 0 ? d.nodes : 1;
  }
  if (u.dimensions == 0 || !values.ok()) return;
  values.require(values.left() == nodes, kField);
  u.value = room;
  for (std::size_t k = 0; values.ok() && k < nodes; ++k) *room++ = values.number(0, frozen::kLongest, kField);
}

void copy_text(char* to, const unsigned char* from, std::size_t size) {
  std::memset(to, 0, ABBE_RUNTIME_TEXT);
  std::memcpy(to, from, size);
  to[size - 1] = 0;
}

void choose(Values& values, abbe_runtime& m) {
  for (std::size_t k = 0; k < m.solved.count; ++k) {
    values.require(!m.axis[m.solved.axis[k]].rotary, "axes of the point");
    m.axis[m.solved.axis[k]].solved = k;
  }
  for (std::size_t k = 0; k < m.turning.count; ++k)
    values.require(m.axis[m.turning.axis[k]].rotary, "axes of the orientation");
  m.reaching_linear = m.solved.count == 3 && m.reaching.count == 3;
  for (std::size_t k = 0; k < m.reaching.count; ++k) {
    const std::size_t i = m.reaching.axis[k];
    m.reaching_unit[k] = m.axis[i].rotary ? m.largest_turn / m.largest_shift : 1;
    m.reaching_linear = m.reaching_linear && m.solved.axis[k] == i;
    for (std::size_t t = 0; t < m.turning.count; ++t)
      values.require(m.turning.axis[t] != i, "axes that correct the point");
  }
  values.require(couplings_can_be_solved(m), "couplings of axes");
  // The point in the world is then found without them.
  values.require(m.solved.count == 0 || m.reaching_linear, "axes that correct the point");
  // By so many errors of direction (point) do the actual derivatives differ from the nominal ones at most, with room
  // for errors that change several times along a turn, so that the iterations converge.
  constexpr double kErrors = 10, kMostOfThem = 0.05;
  const double turned = m.information.largest_correction_rad;
  double moved = turned;
  for (std::size_t k = 0; k < m.reaching.count; ++k) {
    if (m.axis[m.reaching.axis[k]].rotary)
      moved = std::max(moved, m.reaching_unit[k] * m.information.largest_correction_mm);
  }
  m.least_turning = std::min(kErrors * turned, kMostOfThem);
  m.least_reaching = std::min(kErrors * moved, kMostOfThem);
}

}  // namespace

FrozenFile read_frozen(const unsigned char* bytes, std::size_t size, abbe_runtime*& runtime) noexcept {
  using namespace frozen;
  runtime = nullptr;
  if (size >= sizeof kMagic && std::memcmp(bytes, kMagic, sizeof kMagic) != 0) return {ABBE_FILE_FOREIGN, {}};
  if (size < kHeaderBytes) return {ABBE_FILE_SHORT, {}};
  const std::uint32_t order = read_at<std::uint32_t>(bytes, kByteOrderAt);
  if (order != kByteOrder) return {order == 0x0d0c0b0aU ? ABBE_FILE_ORDER : ABBE_FILE_FOREIGN, {}};
  const std::uint32_t written_format = read_at<std::uint32_t>(bytes, kFormatAt);
  const bool has_couplings = written_format > kFormatWithStates;
  const std::uint32_t format = has_couplings ? written_format - kFormatsForCouplings : written_format;
  if (format != kFormatWithStates && format != kFormatWithoutStates) return {ABBE_FILE_VERSION, {}};
  const std::uint64_t count = read_at<std::uint64_t>(bytes, kCountAt);
  const std::size_t present = (size - kHeaderBytes) / 8;
  if (count > present) return {ABBE_FILE_SHORT, {}};
  if (size != kHeaderBytes + 8 * count) return {ABBE_FILE_LONG, {}};
  const std::uint64_t sum = read_at<std::uint64_t>(bytes, kChecksumAt);
  if (checksum(bytes, size) != sum) return {ABBE_FILE_CHECKSUM, {}};

  // Room for machine, groups, states, nodes and coefficients in one piece.
  constexpr std::size_t kGroupsAt = (sizeof(abbe_runtime) + 63) / 64 * 64;
  constexpr std::size_t kStatesAt = kGroupsAt + (kMostGroups * sizeof(FrozenGroup) + 63) / 64 * 64;
  const std::size_t room_at = kStatesAt + (format == kFormatWithStates ? (sizeof(FrozenStates) + 63) / 64 * 64 : 0);
  void* const memory = std::malloc(room_at + 8 * (count + 1));
  if (memory == nullptr) return {ABBE_FILE_NO_MEMORY, {}};
  abbe_runtime& m = *new (memory) abbe_runtime;
  FrozenGroup* const group = reinterpret_cast<FrozenGroup*>(static_cast<unsigned char*>(memory) + kGroupsAt);
  double* room = reinterpret_cast<double*>(static_cast<unsigned char*>(memory) + room_at);
  m.group = group;

  Values values(bytes + kHeaderBytes, static_cast<std::size_t>(count));
  std::size_t groups = 0;
  read_machine(values, m, groups);
  for (std::size_t i = 0; values.ok() && i < m.axes; ++i) read_axis(values, m.axis[i]);
  if (values.ok() && has_couplings) read_frozen_couplings(values, m);
  if (values.ok()) choose(values, m);
  std::size_t before = 0;
  for (std::size_t g = 0; values.ok() && g < groups; ++g) {
    std::size_t axis = 0;
    read_group(values, m, *new (group + g) FrozenGroup, axis, room);
    values.require(axis >= before, "order of groups");
    before = axis;
    if (m.axis[axis].groups++ == 0) m.axis[axis].first_group = g;
  }
  if (values.ok() && format == kFormatWithStates)
    read_states(values, m, *new (static_cast<unsigned char*>(memory) + kStatesAt) FrozenStates, group, groups, room);
  if (values.ok()) read_uncertainty(values, m, room);
  values.require(values.at_end(), "number of values");
  if (!values.ok()) {
    std::free(memory);
    return {ABBE_FILE_CONTENT, values.field()};
  }
  copy_text(m.information.machine, bytes + kNameAt, kNameBytes);
  copy_text(m.information.version, bytes + kVersionAt, kVersionBytes);
  m.information.checksum = sum;
  m.information.source_checksum = read_at<std::uint64_t>(bytes, kSourceAt);
  m.information.bytes = size;
  m.information.axes = static_cast<int>(m.axes);
  m.information.tool_centre = m.solved.count == 3 ? 1 : 0;
  m.information.tool[0] = m.tool.x;
  m.information.tool[1] = m.tool.y;
  m.information.tool[2] = m.tool.z;
  m.information.tool_length_min = m.tool_length_min;
  m.information.tool_length_max = m.tool_length_max;
  runtime = &m;
  return {};
}

// The functions of the C interface are those of the global namespace wherever they are defined.
extern "C" {

int abbe_runtime_load(const void* bytes, size_t size, char* text, size_t text_size,
                      abbe_runtime** runtime) ABBE_NOEXCEPT {
  if (runtime == nullptr) return ABBE_NULL;
  *runtime = nullptr;
  const FrozenFile file = bytes == nullptr ? FrozenFile{ABBE_NULL, {}}
                                           : read_frozen(static_cast<const unsigned char*>(bytes), size, *runtime);
  if (text == nullptr || text_size == 0) return file.result;
  std::size_t used = 0;
  const auto append = [&](std::string_view part) {
    const std::size_t fits = part.size() < text_size - 1 - used ? part.size() : text_size - 1 - used;
    if (fits > 0) std::memcpy(text + used, part.data(), fits);
    used += fits;
  };
  append(abbe_runtime_text(file.result));
  if (!file.field.empty()) {
    append(": ");
    append(file.field);
  }
  text[used] = 0;
  return file.result;
}

void abbe_runtime_free(abbe_runtime* runtime) ABBE_NOEXCEPT { std::free(runtime); }

void abbe_runtime_describe(const abbe_runtime* runtime, abbe_runtime_information* information) ABBE_NOEXCEPT {
  if (runtime != nullptr && information != nullptr) *information = runtime->information;
}

int abbe_runtime_describe_axis(const abbe_runtime* runtime, int axis, abbe_runtime_axis* description) ABBE_NOEXCEPT {
  if (runtime == nullptr || description == nullptr || axis < 0 || axis >= runtime->information.axes) return ABBE_NULL;
  const FrozenAxis& a = runtime->axis[static_cast<std::size_t>(axis)];
  description->letter = a.letter;
  description->number = a.number;
  description->rotary = a.rotary ? 1 : 0;
  description->solved = a.solved != FrozenAxis::kNotSolved ? 1 : 0;
  description->endless = a.endless ? 1 : 0;
  description->travel_min = a.travel_min;
  description->travel_max = a.travel_max;
  description->map_min = a.map_min;
  description->map_max = a.map_max;
  return ABBE_OK;
}

}  // extern "C"

}  // namespace abbe
