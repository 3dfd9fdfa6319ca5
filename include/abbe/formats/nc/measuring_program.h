#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "abbe/machine/machine.h"

namespace abbe {

/// For which control a measuring program is written; docs/measuring-programs.md has the forms and their sources.
enum class NcDialect { iso, linuxcnc, heidenhain, siemens, fanuc };

/// "iso", "linuxcnc", "heidenhain", "siemens", "fanuc", in this order.
const std::vector<std::string>& nc_dialect_names();
/// @returns nothing for another name
std::optional<NcDialect> nc_dialect(const std::string& name);

/// What tells the instrument that the machine stands.
enum class NcTrigger {
  dwell,       ///< nothing: it sees that the machine stands
  m_function,  ///< an M function of the machine's maker
  output       ///< a digital output is switched on and off
};

/// "dwell", "m-function", "output", in this order.
const std::vector<std::string>& nc_trigger_names();
/// @returns nothing for another name
std::optional<NcTrigger> nc_trigger(const std::string& name);

/// Blocks in which one reading is taken.
struct MeasuringStop {
  std::vector<std::vector<double>> via;  ///< poses on the way, [axes] mm or rad
  std::vector<double> pose;              ///< where the reading is taken
  std::string words;                     ///< for a comment: "reading 12: south, reflector r1"
};

/// Readings between which the operator does nothing.
struct MeasuringSection {
  std::string words;  ///< for the operator, before it begins: "set up ball-bar"
  std::vector<MeasuringStop> stops;
};

struct MeasuringProgramOptions {
  NcDialect dialect = NcDialect::iso;
  std::string name = "MEASURE";              ///< of the program, where the control wants one: letters and digits
  std::map<std::string, std::string> words;  ///< name of an axis -> its word, as axis_words() makes them
  std::optional<int> decimals;               ///< of mm and degrees; default_decimals() if nothing is said
  double feed = 0;                           ///< mm/s; 0: rapid traverse
  double dwell = 2;                          ///< s, standing still before the trigger
  NcTrigger trigger = NcTrigger::dwell;
  std::optional<int> number;          ///< of the M function or the output
  double pulse = 0.1;                 ///< s, how long the output is on
  double reading = 0;                 ///< s, standing still after the trigger
  bool machine_coordinates = false;   ///< moves past all zero offsets: G53, SUPA, M91
  std::vector<std::string> comments;  ///< at the top, one line each
};

/// Name of a program for controls that want one: capitals, digits and underlines of the name of its file.
std::string nc_program_name(const std::string& file);

/// Decimals that a control takes: 6, Heidenhain and Siemens 4, Fanuc 3 (increment system IS-B).
int default_decimals(NcDialect dialect);

/// The pose that the program states, after rounding; chain order, mm or rad.
std::vector<double> stated_pose(const Machine& machine, const std::vector<double>& pose, int decimals);

/// The measuring program as text.
///
/// Every section begins with a text for the operator and a programmed stop (M0), if there are several. A reading is a
/// move for every pose on the way, a comment, a dwell, a trigger and another dwell. The first move names all axes, all
/// others those that change.
/// @throws InputError for an axis without a word that the control has, a trigger that it does not have, a trigger
///   without its number or a number without a trigger, a feed of 0 after rounding to 0.001 mm/min, and machine
///   coordinates at a feed where they mean rapid traverse (Fanuc); fields are the options of `abbe program`
std::string measuring_program(const Machine& machine, const std::vector<MeasuringSection>& sections,
                              const MeasuringProgramOptions& options);

}  // namespace abbe
