// The calls of the library that the Python package makes, without Python: what the package is compared with. It is told
// by lines on its standard input what to do, so that both take turns in one run, and answers each with one line: s by
// the clock and of the processor, where there is something to time.
//
//   machine MACHINE_FILE ERRORS_FILE      the model of these errors
//   commands FILE AXES columns|rows       numbers of 8 bytes, [AXES][n] or [n][AXES]
//   poses kept|fresh                      all of them, results in memory that is used again or that is new
//   one CALLS                             so many calls with one pose; time per call
//   results FILE                          points and rotations of the last poses, [12][n]
//   study FILE                            reads a study
//   run                                   it
//   estimates FILE                        values of the last run
#include <sys/mman.h>
#include <time.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "abbe/errors/pose_model.h"
#include "abbe/formats/machine/errors_file.h"
#include "abbe/formats/machine/machine_file.h"
#include "abbe/geometry/parallel_blocks.h"
#include "abbe/study/run_study.h"

namespace {

constexpr std::size_t kBlock = 512, kTask = 16 * kBlock;  // as in python/bindings
constexpr std::size_t kHugePage = std::size_t{1} << 21;
constexpr std::size_t kOutputs = 12;

/// By the clock, and of the processor for all threads.
struct Seconds {
  double clock = 0, processor = 0;
  Seconds operator-(const Seconds& start) const { return {clock - start.clock, processor - start.processor}; }
};

double seconds_of(clockid_t which) {
  timespec time{};
  clock_gettime(which, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Seconds now() { return {seconds_of(CLOCK_MONOTONIC), seconds_of(CLOCK_PROCESS_CPUTIME_ID)}; }

/// New memory in large pages, as for large arrays of the package.
template <class Number>
class Memory {
 public:
  explicit Memory(std::size_t count) {
    const std::size_t bytes = (count * sizeof(Number) + kHugePage) / kHugePage * kHugePage;
    first_ = static_cast<Number*>(std::aligned_alloc(kHugePage, bytes));
    if (!first_) throw std::bad_alloc();
    madvise(first_, bytes, MADV_HUGEPAGE);
  }
  ~Memory() { std::free(first_); }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;
  Number* get() { return first_; }

 private:
  Number* first_;
};

struct Results {
  explicit Results(std::size_t count) : numbers(kOutputs * count), covered(count) {}
  Memory<double> numbers;
  Memory<std::uint8_t> covered;
};

void write_numbers(const std::string& path, const double* numbers, std::size_t count) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(numbers), static_cast<std::streamsize>(count * sizeof(double)));
  if (!file.flush()) throw std::runtime_error(path + " cannot be written");
}

class Calls {
 public:
  void take_machine(const std::string& machine_file, const std::string& errors_file) {
    const abbe::Machine machine = abbe::read_machine(machine_file);
    model_.emplace(machine, abbe::read_errors(errors_file, machine).errors);
  }

  void take_commands(const std::string& path, std::size_t axes, const std::string& order) {
    std::ifstream file(path, std::ios::binary | std::ios::ate);
    if (!file || axes == 0) throw std::runtime_error(path + " cannot be read");
    commands_.resize(static_cast<std::size_t>(file.tellg()) / sizeof(double));
    file.seekg(0).read(reinterpret_cast<char*>(commands_.data()),
                       static_cast<std::streamsize>(commands_.size() * sizeof(double)));
    axes_ = axes;
    count_ = commands_.size() / axes;
    columns_ = order == "columns";
    kept_.reset();
  }

  Seconds poses(bool fresh) {
    const Seconds start = now();
    // Within the time measured, as Python gives back an earlier result.
    if (fresh) kept_.reset();
    if (!kept_) kept_ = std::make_unique<Results>(count_);
    abbe::for_each_block((count_ + kTask - 1) / kTask, 0, [&](std::size_t task) {
      const std::size_t end = std::min(count_, (task + 1) * kTask);
      for (std::size_t first = task * kTask; first < end; first += kBlock) {
        block(first, std::min(kBlock, end - first));
      }
    });
    return now() - start;
  }

  Seconds one(std::size_t calls) {
    std::array<double, kOutputs> out{};
    std::uint8_t covered = 0;
    std::vector<const double*> axis(axes_);
    const Seconds start = now();
    for (std::size_t call = 0; call < calls; ++call) {
      for (std::size_t i = 0; i < axes_; ++i) axis[i] = columns_ ? &commands_[i * count_] : &commands_[i];
      abbe::RotationArrays rotation;
      for (std::size_t e = 0; e < 9; ++e) rotation.r[e] = &out[3 + e];
      model_->poses({axis, 1}, {&out[0], &out[1], &out[2]}, rotation, &covered);
    }
    const Seconds all = now() - start;
    return {all.clock / static_cast<double>(calls), all.processor / static_cast<double>(calls)};
  }

  void write_results(const std::string& path) { write_numbers(path, kept_->numbers.get(), kOutputs * count_); }

  void take_study(const std::string& path) { study_.emplace(abbe::read_study(path)); }

  Seconds run() {
    const Seconds start = now();
    result_.emplace(abbe::run_study(*study_, {.map = false}));
    return now() - start;
  }

  void write_estimates(const std::string& path) {
    const Eigen::VectorXd& values = result_->identification.estimates;
    write_numbers(path, values.data(), static_cast<std::size_t>(values.size()));
  }

 private:
  void block(std::size_t first, std::size_t count) {
    thread_local std::vector<double> turned;
    std::array<const double*, abbe::kMaxAxes> axis{};
    constexpr std::size_t kColumn = kBlock + 8;
    if (!columns_) turned.resize(axes_ * kColumn);
    for (std::size_t i = 0; i < axes_; ++i) {
      axis[i] = columns_ ? &commands_[i * count_ + first] : &turned[i * kColumn];
      for (std::size_t k = 0; k < count && !columns_; ++k) {
        turned[i * kColumn + k] = commands_[(first + k) * axes_ + i];
      }
    }
    double* out = kept_->numbers.get() + first;
    abbe::RotationArrays rotation;
    for (std::size_t e = 0; e < 9; ++e) rotation.r[e] = out + (3 + e) * count_;
    model_->poses({{axis.data(), axes_}, count}, {out, out + count_, out + 2 * count_}, rotation,
                  kept_->covered.get() + first);
  }

  std::optional<abbe::PoseModel> model_;
  std::vector<double> commands_;
  std::size_t axes_ = 0, count_ = 0;
  bool columns_ = true;
  std::unique_ptr<Results> kept_;
  std::optional<abbe::Study> study_;
  std::optional<abbe::StudyResult> result_;
};

Seconds answer(Calls& calls, const std::vector<std::string>& words) {
  const std::string& what = words.at(0);
  if (what == "machine") return calls.take_machine(words.at(1), words.at(2)), Seconds{};
  if (what == "commands") return calls.take_commands(words.at(1), std::stoul(words.at(2)), words.at(3)), Seconds{};
  if (what == "poses") return calls.poses(words.at(1) == "fresh");
  if (what == "one") return calls.one(std::stoul(words.at(1)));
  if (what == "results") return calls.write_results(words.at(1)), Seconds{};
  if (what == "study") return calls.take_study(words.at(1)), Seconds{};
  if (what == "run") return calls.run();
  if (what == "estimates") return calls.write_estimates(words.at(1)), Seconds{};
  throw std::runtime_error("no request: " + what);
}

}  // namespace

int main() {
  Calls calls;
  for (std::string line; std::getline(std::cin, line);) {
    std::vector<std::string> words;
    std::istringstream stream(line);
    for (std::string word; std::getline(stream, word, '\t');) words.push_back(word);
    try {
      const Seconds time = answer(calls, words);
      std::printf("%.9e %.9e\n", time.clock, time.processor);
    } catch (const std::exception& error) {
      std::printf("failed: %s\n", error.what());
    }
    std::fflush(stdout);
  }
  return 0;
}
