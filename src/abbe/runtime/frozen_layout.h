#pragma once

#include <cstddef>
#include <cstdint>

/// Layout of a *.abbec file, shared by writer and reader; docs/runtime.md describes it.
namespace abbe::frozen {

inline constexpr std::size_t kHeaderBytes = 128;
inline constexpr unsigned char kMagic[8] = {0x89, 'A', 'B', 'B', 'E', 'C', '\r', '\n'};
inline constexpr std::uint32_t kByteOrder = 0x0a0b0c0dU;

// Places in the header, bytes.
inline constexpr std::size_t kByteOrderAt = 8;
inline constexpr std::size_t kFormatAt = 12;
inline constexpr std::size_t kCountAt = 16;
inline constexpr std::size_t kChecksumAt = 24;
inline constexpr std::size_t kSourceAt = 32;
inline constexpr std::size_t kVersionAt = 40;
inline constexpr std::size_t kVersionBytes = 24;
inline constexpr std::size_t kNameAt = 64;
inline constexpr std::size_t kNameBytes = 64;

// Values of the machine, at the beginning; all values are 64-bit floating point.
enum Value : std::size_t {
  kAxes = 0,
  kSolved = 1,    // count, three axes
  kTurning = 5,   // count, three axes
  kReaching = 9,  // count, three axes
  kLargestTurn = 13,
  kLargestShift = 14,
  kToolReference = 15,
  kTool = 18,
  kToolError = 21,
  kToolDirection = 24,
  kToolLengths = 27,
  kWorldZero = 29,
  kRotation = 32,
  kShift = 41,
  kLargestCorrection = 44,  // mm, rad
  kAccuracy = 46,           // mm, rad
  kWorstIterations = 48,
  kGroups = 49,
  kMachineValues = 50
};

// Values of an axis.
enum AxisValue : std::size_t {
  kRotary = 0,
  kToolSide = 1,
  kPrimed = 2,
  kErrorFirst = 3,
  kEndless = 4,
  kLetter = 5,
  kNumber = 6,
  kDirection = 7,
  kPoint = 10,
  kActualDirection = 13,
  kActualCentre = 16,
  kZeroPosition = 19,
  kMap = 20,
  kTravel = 22,
  kAxisValues = 24
};

// Values of a group of functions, before its nodes (piecewise: functions + 1) and coefficients (functions times 6,
// piecewise: times 4 times 6).
enum GroupValue : std::size_t {
  kGroupAxis = 0,
  kGroupKind = 1,  // 0 Chebyshev, 1 Fourier, 2 piecewise cubic
  kFunctions = 2,
  kEverywhere = 3,
  kRange = 4,       // lowest and highest position, beyond which the errors stay as they are
  kParameters = 6,  // Chebyshev: from, to; Fourier: period, 0; piecewise: period (0: none), 0
  kGroupValues = 8
};

// After the groups: the uncertainty of the correction.
enum UncertaintyValue : std::size_t {
  kDimensions = 0,     // 0: not stated, and nothing follows these values
  kUncertainties = 1,  // largest, mean, largest difference of the lattice; mm
  kUncertaintyValues = 4
};
// Values of a dimension; behind the last one the uncertainties in the nodes, the last dimension fastest.
enum DimensionValue : std::size_t {
  kDimensionAxis = 0,  // 16: tool length
  kNodes = 1,
  kEnds = 2,
  kPeriodic = 4,
  kDimensionValues = 5
};

// Format 3, between the groups and the uncertainty: states, and errors that depend on them. Numbers of items stand
// before them; 16 is no factor.
//   states: kind (0 measured, 1 lag, 2 axis, 3 gravity), axis or state of the channel, unit, reference, time constant,
//           range, 32 letters; gravity: loads (axis, weight, point)
//   factors that are given: first and second state, mm per unit; factors of the pose: the same
//   groups with a factor of the pose: its number, then as a group
//   blocks, in the order of the groups: group, given factor, coefficients
//   location errors, in the order of the axes: axis, given factor, factor of the pose, shift, tilt, zero position
inline constexpr std::uint32_t kFormatWithStates = 3;
inline constexpr std::uint32_t kFormatWithoutStates = 2;
// With coupled axes these formats are higher by two. Behind the axes: number of couplings, then of each its axis, the
// axis whose command it contains, and the ratio; those whose axis others are coupled to come first.
inline constexpr std::uint32_t kFormatsForCouplings = 2;
inline constexpr std::size_t kMostCouplings = 32;
inline constexpr double kLargestRatio = 1e6;
inline constexpr std::size_t kStateName = 32;
inline constexpr std::size_t kMostLoads = 64;
inline constexpr std::size_t kMostBlocks = 256;
inline constexpr std::size_t kMostLocations = 128;

inline constexpr std::size_t kMostFunctions = 64;    // of a Chebyshev or Fourier group
inline constexpr std::size_t kMostIntervals = 4096;  // of a piecewise group
inline constexpr std::size_t kMostGroups = 96;

// What an input may be, and what a file may contain: with it every result stays finite and bounded.
inline constexpr double kLongest = 1e6;        // mm or rad, of a command or a place
inline constexpr double kLargestError = 1000;  // mm or rad, of a coefficient
inline constexpr double kMostBeyond = 1.1;     // of the argument of Chebyshev functions, beyond [-1, 1]

/// CRC-64/XZ of a file, its checksum field counted as zeros. Every change of up to 64 neighbouring bits shows.
std::uint64_t checksum(const unsigned char* bytes, std::size_t size);
/// CRC-64/XZ of any bytes.
std::uint64_t crc(const unsigned char* bytes, std::size_t size);

}  // namespace abbe::frozen
