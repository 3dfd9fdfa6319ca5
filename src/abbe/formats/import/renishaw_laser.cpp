// Positioning runs of a Renishaw laser interferometer (.rtl); docs/import.md has the description and its sources.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "abbe/formats/import/foreign_word.h"
#include "abbe/formats/import/instrument_lines.h"
#include "abbe/formats/import/instrument_readers.h"
#include "abbe/formats/text/csv_header.h"
#include "abbe/formats/text/csv_reader.h"
#include "abbe/formats/text/input_error.h"
#include "abbe/formats/text/list_text.h"

namespace abbe {
namespace {

constexpr std::size_t kMostTargets = 1'000'000, kMostLaserRuns = 1'000'000;
constexpr double kNotMeasured = 1e20;
constexpr std::string_view kSectionMark = "::";

/// One line below "Run Target Data:".
struct LaserReading {
  std::size_t run = 0, target = 0;  ///< from 1
  std::string_view value;
  double number = 0;
  std::size_t line = 0;

  bool is_measured() const { return std::abs(number) != kNotMeasured; }
};

/// How the targets of a run follow each other.
struct LaserRun {
  std::size_t last = 0;  ///< target of the row above, from 1; 0: there is none
  int direction = 0;     ///< +1: towards larger positions
  bool all_zero = true;  ///< no other value was measured
};

class LaserReader {
 public:
  LaserReader(std::string_view text, const std::string& file, const ImportHints& hints)
      : lines_(text), file_(file), hints_(hints) {}

  InstrumentTable read() {
    while (lines_.next()) {
      if (lines_.text().find(':') + kSectionMark.size() == lines_.text().size() &&
          lines_.text().ends_with(kSectionMark)) {
        begin_section();
      } else {
        take_line();
      }
    }
    check_counts();
    find_directions();
    find_return_runs();
    write_columns();
    write_rows();
    say_what_was_found();
    return std::move(table_);
  }

 private:
  [[noreturn]] void refuse(const std::string& field, const std::string& problem, const std::string& expected) const {
    refuse(lines_.number(), field, problem, expected);
  }
  [[noreturn]] void refuse(std::size_t line, const std::string& field, const std::string& problem,
                           const std::string& expected) const {
    throw InputError({.file = file_, .line = line, .field = field}, problem, expected);
  }

  void begin_section() {
    section_ = csv_trimmed(lines_.text().substr(0, lines_.text().size() - kSectionMark.size()));
    in_targets_ = in_readings_ = false;
    if (section_ == "EOF") has_end_ = true;
  }

  void take_line() {
    const std::string_view line = lines_.text();
    if (in_readings_) return take_reading(line);
    const std::optional<InstrumentKey> pair = instrument_key(line);
    if (!pair) {
      if (in_targets_) return take_targets(line);
      return take_other(line);
    }
    in_targets_ = false;
    if (section_ == "HEADER" && pair->key == "File type") return take_file_type(pair->value);
    if (section_ == "HEADER" && pair->key == "Owner") owner_ = pair->value;
    if (section_ == "TARGET DATA" && pair->key == "Target-count") {
      target_count_ = instrument_count(pair->value, 1, kMostTargets, file_, lines_.number(), "Target-count");
      target_count_line_ = lines_.number();
      return;
    }
    if (section_ == "TARGET DATA" && pair->key == "Targets") {
      in_targets_ = true;
      return take_targets(pair->value);
    }
    if (section_ == "TARGET DATA" && pair->key == "Flags") return take_flags(pair->value);
    if (section_ == "RUNS" && pair->key == "Run-count") {
      run_count_ = instrument_count(pair->value, 1, kMostLaserRuns, file_, lines_.number(), "Run-count");
      return;
    }
    if (section_ == "DEVIATIONS" && pair->key == "Run Target Data") {
      in_readings_ = true;
      return;
    }
    if (!pair->value.empty()) table_.facts.push_back({std::string(pair->key), std::string(pair->value)});
  }

  void take_file_type(std::string_view type) {
    if (small_letters(type) == "rtl") {
      has_type_ = true;
      return;
    }
    refuse(
        "File type", fmt::format("'{}' is not read", shown_text(type)),
        "rtl, linear positioning: no public description says in which unit files of other types have their readings");
  }

  void take_targets(std::string_view line) {
    for (const std::string_view word : instrument_words(line)) {
      targets_.push_back(instrument_number(word, file_, lines_.number(), "Targets", "a position in mm"));
      target_texts_.push_back(word);
      if (targets_.size() > kMostTargets) refuse("Targets", "there are more than 1000000", "fewer");
    }
  }

  /// The second tells whether the test has runs from one side only; what the others mean is not described.
  void take_flags(std::string_view value) {
    const std::vector<std::string_view> words = instrument_words(value);
    if (words.size() > 1 && words[1] == "0") both_sides_ = true;
    if (words.size() > 1 && words[1] == "1") one_side_ = true;
    table_.not_read.push_back(
        fmt::format("Flags '{}' but for the second, which tells runs from one side", shown_text(value)));
  }

  void take_other(std::string_view line) {
    if (section_ == "TARGET DATA" || section_ == "DEVIATIONS" || section_ == "RUNS" || section_ == "HEADER") {
      refuse(section_, fmt::format("'{}' is no key with a value", shown_text(line)), "'key : value'");
    }
    table_.not_read.push_back(
        fmt::format("line {} of {}", lines_.number(), section_.empty() ? "no section" : shown_text(section_)));
  }

  void take_reading(std::string_view line) {
    const std::vector<std::string_view> words = instrument_words(line);
    if (words.size() != 3) {
      refuse("Run Target Data", "the line has " + counted(words.size(), "field", "fields"),
             "run, target and deviation in um");
    }
    LaserReading reading;
    reading.line = lines_.number();
    reading.run = instrument_count(words[0], 1, kMostLaserRuns, file_, reading.line, "Run");
    reading.target = instrument_count(words[1], 1, kMostTargets, file_, reading.line, "Target");
    reading.value = words[2];
    double value = 0;
    if (parse_number(reading.value, 0, value) == NumberProblem::none && std::abs(value) == kNotMeasured) {
      reading.number = value;
    } else {
      reading.number = instrument_number(reading.value, file_, reading.line, "Data", "a deviation in um");
    }
    readings_.push_back(reading);
  }

  void check_counts() const {
    if (!has_type_) refuse(0, "File type", "is missing", "rtl");
    if (target_count_ == 0) refuse(0, "Target-count", "is missing", "the number of targets");
    if (targets_.size() != target_count_) {
      refuse(target_count_line_, "Target-count",
             fmt::format("is {}, and {} listed", target_count_, counted(targets_.size(), "target is", "targets are")),
             "as many targets as are listed");
    }
    if (run_count_ == 0) refuse(0, "Run-count", "is missing", "the number of runs");
    if (readings_.empty()) refuse(0, "Run Target Data", "there are no readings", "run, target and deviation in um");
    for (const LaserReading& reading : readings_) {
      if (reading.run > run_count_)
        refuse(reading.line, "Run", fmt::format("is {}", reading.run), of_count(run_count_));
      if (reading.target > target_count_) {
        refuse(reading.line, "Target", fmt::format("is {}", reading.target), of_count(target_count_));
      }
    }
  }
  static std::string of_count(std::size_t count) { return fmt::format("1 to {}", count); }

  /// The rows of a run are in the order in which its targets were approached.
  void find_directions() {
    runs_.resize(run_count_);
    for (const LaserReading& reading : readings_) {
      LaserRun& run = runs_[reading.run - 1];
      if (reading.is_measured() && reading.number != 0) run.all_zero = false;
      if (run.last != 0) {
        const double step = targets_[reading.target - 1] - targets_[run.last - 1];
        const int direction = step > 0 ? 1 : step < 0 ? -1 : 0;
        if (direction == 0 || (run.direction != 0 && direction != run.direction)) {
          refuse(reading.line, "Target",
                 fmt::format("run {} goes from target {} to target {}, not on in one direction", reading.run, run.last,
                             reading.target),
                 "targets in the order of their positions, which shows the side from which each was approached");
        }
        run.direction = direction;
      }
      run.last = reading.target;
    }
    for (const LaserReading& reading : readings_) {
      if (runs_[reading.run - 1].direction != 0) continue;
      refuse(reading.line, "Run", fmt::format("run {} has only one target, so its direction is unknown", reading.run),
             "two targets or more");
    }
  }

  /// A test from one side may have runs of nothing but zeros between its own, for the way back.
  void find_return_runs() {
    if (!one_side_) return;
    const int side = runs_[readings_.front().run - 1].direction;
    for (LaserRun& run : runs_) {
      if (run.direction != -side) continue;
      if (run.all_zero) {
        ++return_runs_;
      } else {
        has_other_side_ = true;
      }
    }
    if (has_other_side_) return_runs_ = 0;
  }
  bool is_return(const LaserRun& run) const {
    return return_runs_ > 0 && run.all_zero && run.direction != runs_[readings_.front().run - 1].direction;
  }

  void write_columns() {
    if (!hints_.length_unit.empty() && hints_.length_unit != "mm") {
      throw InputError({.field = "--length-unit"}, fmt::format("{} is not known of such files", hints_.length_unit),
                       "mm, with deviations in um; other units by a mapping file (--mapping)");
    }
    const bool given = !hints_.length_unit.empty();
    InstrumentColumn target{"Targets", "target", "mm", given, given ? "mm as given" : "the positions of the targets"};
    InstrumentColumn deviation{"Data", "deviation", "um", given};
    deviation.reason = given ? "um, as usual in such files with targets in mm; actual minus target"
                             : "actual minus target, as the programs that write such files compute it";
    if (!given) {
      target.doubts.emplace_back(
          "states no unit; mm is assumed, as by programs that read such files (--length-unit mm)");
      deviation.doubts.emplace_back("states no unit; um is assumed, as such programs do (--length-unit mm says both)");
    }
    table_.kind = ImportKind::positioning;
    table_.columns = {{"Run", "run", "", true, "the number of the run"},
                      {"direction", "direction", "", true, "from the order of the targets in each run"},
                      std::move(target),
                      std::move(deviation)};
  }

  void write_rows() {
    for (const LaserReading& reading : readings_) {
      const LaserRun& run = runs_[reading.run - 1];
      if (is_return(run)) continue;
      if (!reading.is_measured()) {
        ++not_measured_;
        continue;
      }
      table_.rows += fmt::format("{},{},{},{}\n", reading.run, run.direction > 0 ? '+' : '-',
                                 target_texts_[reading.target - 1], reading.value);
      table_.lines.push_back(reading.line);
    }
    if (table_.lines.empty()) refuse(0, "Data", "no target was measured", "deviations in um");
  }

  void say_what_was_found() {
    const auto [least, most] = std::minmax_element(targets_.begin(), targets_.end());
    const auto runs_towards = [&](int direction) {
      return std::count_if(runs_.begin(), runs_.end(),
                           [direction](const LaserRun& run) { return run.direction == direction; });
    };
    const auto forth = runs_towards(1), back = runs_towards(-1);
    table_.reasons.push_back(
        fmt::format("{} from {:.9g} to {:.9g}", counted(target_count_, "target", "targets"), *least, *most));
    table_.reasons.push_back(fmt::format("{}: {} towards larger positions, {} towards smaller ones",
                                         counted(run_count_, "run", "runs"), forth, back));
    if (not_measured_ > 0) {
      table_.not_read.push_back(counted(not_measured_, "target", "targets") + " without a reading (-1e20)");
    }
    if (return_runs_ > 0) {
      table_.not_read.push_back(counted(return_runs_, "run", "runs") + " of nothing but zeros, for the way back");
    }
    if (readings_.size() < run_count_ * target_count_) {
      table_.doubts.push_back(
          fmt::format("{} of the {} readings of all runs are there", readings_.size(), run_count_ * target_count_));
    }
    if (!has_end_) table_.doubts.emplace_back("the file does not end in EOF::, so it may be cut short");
    if (small_letters(owner_).find("linear") == std::string::npos) {
      table_.doubts.emplace_back("its Owner is not Linear, so its readings may be something else than positions");
    }
    if (has_other_side_) table_.doubts.emplace_back("the Flags speak of runs from one side, and there are both");
    if (both_sides_ && (back == 0 || forth == 0)) {
      table_.doubts.emplace_back(
          "the Flags speak of runs from both sides, and the order of the targets is that of one side");
    }
  }

  InstrumentLines lines_;
  const std::string& file_;
  const ImportHints& hints_;
  InstrumentTable table_;
  std::string section_, owner_;
  bool in_targets_ = false, in_readings_ = false, has_end_ = false, has_type_ = false;
  bool both_sides_ = false, one_side_ = false, has_other_side_ = false;
  std::size_t target_count_ = 0, target_count_line_ = 0, run_count_ = 0, not_measured_ = 0, return_runs_ = 0;
  std::vector<double> targets_;
  std::vector<std::string_view> target_texts_;
  std::vector<LaserReading> readings_;
  std::vector<LaserRun> runs_;
};

}  // namespace

std::optional<Recognition> recognise_renishaw_laser(std::string_view text) {
  constexpr int kLooked = 10;
  InstrumentLines lines(text);
  if (!lines.next() || lines.text() != "HEADER::") return std::nullopt;
  const std::size_t first = lines.number();
  for (int i = 0; i < kLooked && lines.next(); ++i) {
    const std::optional<InstrumentKey> pair = instrument_key(lines.text());
    if (!pair || pair->key != "File type") continue;
    return Recognition{fmt::format("HEADER:: in line {}, file type '{}'", first, shown_text(pair->value))};
  }
  return std::nullopt;
}

InstrumentTable read_renishaw_laser(std::string_view text, const std::string& file, const ImportHints& hints) {
  return LaserReader(text, file, hints).read();
}

}  // namespace abbe
