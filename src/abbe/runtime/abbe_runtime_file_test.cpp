#include <cstring>
#include <limits>

#include "abbe/runtime/frozen_for_test.h"
#include "abbe/runtime/frozen_layout.h"

namespace abbe {
namespace {

std::vector<unsigned char> some_file() {
  const Machine machine = test::trunnion_mill();
  return test::quickly_frozen(machine, test::tens_of_micrometres(machine, 3)).bytes;
}

int load(const std::vector<unsigned char>& bytes, std::string* text = nullptr) {
  abbe_runtime* runtime = nullptr;
  char message[200];
  const int result = abbe_runtime_load(bytes.data(), bytes.size(), message, sizeof message, &runtime);
  EXPECT_EQ(runtime == nullptr, result != ABBE_OK);
  abbe_runtime_free(runtime);
  if (text != nullptr) *text = message;
  return result;
}

/// A value of the machine, an axis or a group written anew, with the checksum that belongs to it.
void set_value(std::vector<unsigned char>& bytes, std::size_t place, double value) {
  std::memcpy(bytes.data() + frozen::kHeaderBytes + 8 * place, &value, sizeof value);
  const std::uint64_t sum = frozen::checksum(bytes.data(), bytes.size());
  std::memcpy(bytes.data() + frozen::kChecksumAt, &sum, sizeof sum);
}

TEST(RuntimeFile, ItsChecksumIsTheOneOfXz) {
  const unsigned char digits[] = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(frozen::crc(digits, sizeof digits), 0x995dc9bbdf1939faULL);  // check value of CRC-64/XZ
}

TEST(RuntimeFile, SaysWhatItIs) {
  const Machine machine = test::trunnion_mill();
  const FrozenCompensation frozen = test::quickly_frozen(machine, test::tens_of_micrometres(machine, 3), true);
  const test::RuntimePointer runtime = test::loaded(frozen.bytes);
  abbe_runtime_information about;
  abbe_runtime_describe(runtime.get(), &about);
  EXPECT_STREQ(about.machine, "trunnion mill");
  EXPECT_STREQ(about.version, "0.0.test");
  EXPECT_EQ(about.axes, 5);
  EXPECT_EQ(about.tool_centre, 1);
  EXPECT_EQ(about.bytes, frozen.bytes.size());
  EXPECT_EQ(about.tool[2], -150);
  EXPECT_EQ(about.largest_correction_mm, frozen.largest_correction);
  EXPECT_GT(about.largest_correction_mm, 0.05);
  EXPECT_LT(about.accuracy_mm, 1e-9);
  EXPECT_GE(about.worst_iterations, 2);
  abbe_runtime_axis axis;
  ASSERT_EQ(abbe_runtime_describe_axis(runtime.get(), 0, &axis), ABBE_OK);
  EXPECT_EQ(axis.letter, 'C');
  EXPECT_EQ(axis.rotary, 1);
  EXPECT_EQ(axis.endless, 1);
  EXPECT_EQ(axis.solved, 0);
  ASSERT_EQ(abbe_runtime_describe_axis(runtime.get(), 4, &axis), ABBE_OK);
  EXPECT_EQ(axis.letter, 'Z');
  EXPECT_EQ(axis.solved, 1);
  EXPECT_EQ(axis.travel_min, -510);
  EXPECT_EQ(abbe_runtime_describe_axis(runtime.get(), 5, &axis), ABBE_NULL);
  // Where nothing is turned, the world is that of the joints.
  const double joints[5] = {0, 0, 10, 20, -30};
  double point[3], words[5];
  const double none[3] = {0, 0, 0};
  ASSERT_GE(abbe_runtime_nominal_forward(runtime.get(), joints, none, point, words), 0);
  EXPECT_NEAR(point[0], 20, 1e-12);
  EXPECT_NEAR(point[1], 10, 1e-12);
  EXPECT_NEAR(point[2], -30, 1e-12);
}

TEST(RuntimeFile, EveryChangedByteIsRefused) {
  const std::vector<unsigned char> sound = some_file();
  ASSERT_EQ(load(sound), ABBE_OK);
  for (std::size_t i = 0; i < sound.size(); ++i) {
    std::vector<unsigned char> damaged = sound;
    damaged[i] = static_cast<unsigned char>(damaged[i] ^ (1U << (i % 8)));
    EXPECT_LT(load(damaged), 0) << "byte " << i;
  }
}

TEST(RuntimeFile, ATruncatedOrLongerOneIsRefused) {
  const std::vector<unsigned char> sound = some_file();
  for (std::size_t size = 1; size < sound.size(); size += size < 200 ? 1 : 97) {
    EXPECT_EQ(load({sound.begin(), sound.begin() + static_cast<std::ptrdiff_t>(size)}), ABBE_FILE_SHORT) << size;
  }
  std::vector<unsigned char> longer = sound;
  longer.push_back(0);
  EXPECT_EQ(load(longer), ABBE_FILE_LONG);
  longer.resize(sound.size() + 8);
  EXPECT_EQ(load(longer), ABBE_FILE_LONG);
}

TEST(RuntimeFile, AForeignOneIsRefusedAndTheReasonSaid) {
  const std::vector<unsigned char> sound = some_file();
  std::string text;
  std::vector<unsigned char> other(1000, 'x');
  EXPECT_EQ(load(other, &text), ABBE_FILE_FOREIGN);
  EXPECT_EQ(text, "the file is not a frozen compensation");
  other = sound;
  std::swap(other[8], other[11]);
  std::swap(other[9], other[10]);
  EXPECT_EQ(load(other, &text), ABBE_FILE_ORDER);
  other = sound;
  other[frozen::kFormatAt] = ABBE_RUNTIME_FORMAT + 1;
  EXPECT_EQ(load(other, &text), ABBE_FILE_VERSION);
  EXPECT_NE(text.find("freeze the compensation again"), std::string::npos);
  other = sound;
  other.back() = static_cast<unsigned char>(other.back() ^ 1U);
  EXPECT_EQ(load(other, &text), ABBE_FILE_CHECKSUM);
  EXPECT_EQ(abbe_runtime_load(nullptr, 0, nullptr, 0, nullptr), ABBE_NULL);
}

TEST(RuntimeFile, ContentThatCannotBeIsRefusedThoughTheChecksumIsRight) {
  const std::vector<unsigned char> sound = some_file();
  constexpr std::size_t kAxis = frozen::kMachineValues, kGroup = kAxis + 5 * frozen::kAxisValues;
  const double not_a_number = std::numeric_limits<double>::quiet_NaN();
  struct Change {
    std::size_t place;
    double value;
    const char* field;
  };
  for (const Change& change : {Change{frozen::kAxes, 17, "number of axes"},
                               Change{frozen::kAxes, 0, "number of axes"},
                               Change{frozen::kAxes, 2.5, "number of axes"},
                               Change{frozen::kSolved, 2, "axes of the point"},
                               Change{frozen::kSolved + 1, 3, "axes of the point"},
                               Change{frozen::kSolved + 1, 0, "axes of the point"},
                               Change{frozen::kTurning + 1, 9, "axes of the orientation"},
                               Change{frozen::kTurning + 1, 2, "axes of the orientation"},
                               Change{frozen::kReaching + 1, 0, "axes that correct the point"},
                               Change{frozen::kLargestTurn, 0, "largest turn"},
                               Change{frozen::kTool, not_a_number, "tool"},
                               Change{frozen::kToolDirection, 0.5, "tool direction"},
                               Change{frozen::kRotation, -1, "workpiece frame"},
                               Change{frozen::kGroups, 3, "uncertainty of the correction"},
                               Change{frozen::kGroups, 60, "group"},
                               Change{kAxis + frozen::kLetter, 33, "letter of an axis"},
                               Change{kAxis + frozen::kDirection, 0.1, "direction of an axis"},
                               Change{kAxis + frozen::kActualDirection + 2, -1, "direction of an axis with errors"},
                               Change{kGroup + frozen::kGroupKind, 3, "kind of a group"},
                               Change{kGroup + frozen::kFunctions, 0, "size of a group"},
                               Change{kGroup + frozen::kFunctions, 63, "group"},
                               Change{kGroup + frozen::kParameters, 0, "period of a group"},
                               Change{kGroup + frozen::kGroupValues, 1e9, "coefficients of a group"}}) {
    std::vector<unsigned char> changed = sound;
    set_value(changed, change.place, change.value);
    std::string text;
    EXPECT_EQ(load(changed, &text), ABBE_FILE_CONTENT) << change.field << " " << change.value;
    EXPECT_NE(text.find(change.field), std::string::npos) << text;
  }
}

TEST(RuntimeFile, WhatCannotBeFrozenIsSaid) {
  Machine machine = test::three_axis_mill();
  ErrorSet errors;
  errors.composition.first_order = true;
  EXPECT_NE(freeze(machine, errors, {}).problem.find("first order"), std::string::npos);
  Basis basis{.kind = BasisKind::chebyshev, .order = 80, .from = 0, .to = 500};
  ErrorSet many;
  many.motions.push_back({0, Component::X, basis, std::vector<double>(81, 1e-4), {}});
  EXPECT_EQ(freeze(machine, many, {}).problem, "EXX: more than 64 functions");
  machine.axes[0].direction = {0, 0, 2};
  EXPECT_NE(freeze(machine, {}, {}).problem, "");
}

TEST(RuntimeFile, TextIsCutToTheRoomThereIs) {
  abbe_runtime* runtime = nullptr;
  char text[6] = {'z', 'z', 'z', 'z', 'z', 'z'};
  EXPECT_EQ(abbe_runtime_load("abc", 3, text, 5, &runtime), ABBE_FILE_SHORT);
  EXPECT_STREQ(text, "the ");
  EXPECT_EQ(text[5], 'z');
}

}  // namespace
}  // namespace abbe
