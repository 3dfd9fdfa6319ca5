#pragma once

#include <cstddef>
#include <functional>
#include <stop_token>

#include "abbe/formats/study/study_file.h"
#include "abbe/geometry/stopped.h"
#include "abbe/study/results.h"
#include "abbe/study/study_result.h"
#include "abbe/study/study_text.h"
#include "abbe/study/trust.h"

// A whole study, as `abbe run` does it; tests/install/consumer/study.cpp compiles this program:
//
//   #include <abbe/study/run_study.h>
//
//   #include <cstdio>
//
//   int main(int /*argc*/, char** arguments) {
//     abbe::Study study = abbe::read_study(arguments[1]);
//     study.output = arguments[2];
//     const abbe::StudyResult result = abbe::run_study(study);
//     abbe::write_results(study, result);
//     std::fputs(abbe::study_text(study, result, nullptr).c_str(), stdout);
//     return abbe::says_no(study, result) ? 1 : 0;
//   }

namespace abbe {

/// The parts of a study that take time, in their order.
enum class StudyStep { gather, identify, map };

/// "simulating readings" or "reading measurements", "identifying", "mapping the volumetric error".
const char* step_words(const Study& study, StudyStep step);

/// What a study is done with besides its file.
struct RunOptions {
  bool accept_misfit = false;  ///< the result is to be used although it is distrusted; its errors file says so
  bool map = true;             ///< false: no map of the volumetric error
  /// Called at the beginning of every step and during it, one call at a time but from any thread: done of total.
  std::function<void(StudyStep step, std::size_t done, std::size_t total)> progress{};
  std::stop_token stop{};  ///< looked at during every step
};

/// Reads or simulates the readings of a study, identifies, validates at poses that were not used, judges whether the
/// result may be trusted, and maps the volumetric error. Files are read, none is written: write_results() does that.
///
/// @throws InputError naming file, line and field; Stopped where that was asked for
StudyResult run_study(const Study& study, const RunOptions& options = {});

}  // namespace abbe
