#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "abbe/errors/poses.h"
#include "abbe/machine/machine.h"

namespace abbe {

/// Where a machine has to stand for one reading, and what is read there.
struct ListedReading {
  std::vector<double> pose;                 ///< [axes] chain order, mm or rad
  std::size_t line = 0;                     ///< of the file, from 1; 0: in no file
  std::string setup, station, what, point;  ///< empty where the file has no such column; `what`: target of the reading
};

/// Readings in the order of a file.
struct ReadingList {
  std::vector<ListedReading> readings;
  std::string what;           ///< what the file calls the column of targets: "reflector", "item", "target"; or empty
  bool has_approach = false;  ///< the file says from which side axes came (X_approach)
};

/// CSV with a column for every axis, as `abbe plan -o` and files of readings have them: see docs/formats.md.
///
/// Of the other columns `setup`, `station`, `reflector`, `item` or `target`, and `point` are read; measured values,
/// uncertainties and all others are passed over.
/// @throws InputError for a missing axis, a unit that is not one of the axis, a pose outside a travel, and no reading
ReadingList parse_reading_list(std::string_view text, const std::string& file, const Machine& machine);
ReadingList read_reading_list(const std::filesystem::path& path, const Machine& machine);

/// Readings at poses that are in no file; only their poses are known.
/// @param name  of the poses, for messages
/// @throws InputError for a pose outside a travel, and no pose
ReadingList listed_readings(const PoseList& poses, const std::string& name, const Machine& machine);

/// "reading 12 (line 14)"; without its line if it is in no file.
std::string reading_words(std::size_t number, const ListedReading& reading);

}  // namespace abbe
