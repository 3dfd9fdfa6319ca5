// An NC program of 1,000,000 blocks through reader, interpreter, a corrector that changes nothing, and writer: blocks
// per second and memory, beside std::getline, std::istringstream and std::ostream in the same run, which know no modes,
// no offsets and no errors, and beside LinuxCNC's own interpreter, rs274, which only reads, where it is installed.
#include "abbe/formats/nc/nc_program.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>

#include "abbe/errors/random_stream.h"
#include "abbe/formats/files/streamed_file.h"
#include "abbe/formats/files/text_file.h"

namespace {

class Unchanged final : public abbe::MoveCorrector {
 public:
  void correct(std::span<const abbe::ProgramMove> moves, abbe::CorrectedPieces& corrected) override {
    corrected.pieces.clear();
    corrected.first.assign(1, 0);
    for (const abbe::ProgramMove& move : moves) {
      corrected.pieces.push_back({move.end, move.feed, move.feed_mode});
      corrected.first.push_back(corrected.pieces.size());
    }
  }
};

const std::string& folder() {
  // Once: the processes that are measured have other numbers.
  static const std::string path = std::filesystem::temp_directory_path() / ("abbe_nc_" + std::to_string(::getpid()));
  return path;
}

std::string program(int blocks) {
  std::string path = folder() + "/" + std::to_string(blocks) + ".ngc";
  std::FILE* const file = std::fopen(path.c_str(), "w");
  if (file == nullptr) std::abort();
  abbe::RandomStream random(1);
  std::fputs("G21 G90 G94\n", file);
  for (int i = 1; i <= blocks; ++i) {
    const double t = 1e-3 * i;
    std::fprintf(file, "N%d G1 X%.4f Y%.4f Z%.4f A%.4f C%.4f F%.1f\n", i, 50 * std::cos(t) + random.uniform(-1, 1),
                 50 * std::sin(t), -10 - 5 * std::sin(3 * t), 30 * std::sin(t), std::fmod(t, 360), 1000.0 + i % 7);
  }
  std::fputs("M2\n", file);
  std::fclose(file);
  return path;
}

void abbe_program(const std::string& path) {
  abbe::NcProgramOptions options;
  for (std::size_t k = 0; k < 6; ++k) options.start[k] = 0;
  Unchanged corrector;
  abbe::MappedFile program(path);
  abbe::StreamedFile out(path + ".out");
  abbe::correct_nc_program(
      program.text(), path, options, corrector, [&](std::string_view text) { out.append(text); },
      [&](std::size_t at) { program.forget(at); });
  out.commit();
}

/// What anybody would write first.
void plain_streams(const std::string& path) {
  std::ifstream in(path);
  std::ofstream out(path + ".plain");
  out << std::fixed << std::setprecision(6);
  std::string line;
  while (std::getline(in, line)) {
    std::istringstream words(line);
    std::string word;
    const char* between = "";
    while (words >> word) {
      const double value = std::stod(word.substr(1));
      out << between << word[0];
      if (word[0] == 'N' || word[0] == 'G' || word[0] == 'M') {
        out << static_cast<int>(value);
      } else {
        out << value;
      }
      between = " ";
    }
    out << '\n';
  }
}

void linuxcnc(const std::string& path) {
  const std::string command = "cd " + folder() + " && rs274 -g -v none.var " + path + " >/dev/null 2>&1";
  if (std::system(command.c_str()) != 0) std::fprintf(stderr, "rs274 failed\n");
}

struct Cost {
  double seconds = 0;
  double peak_mb = 0;
};

/// Shortest of several runs, each in a process of its own so that its memory is its own.
template <typename Run>
Cost measure(int times, Run&& run) {
  Cost best{1e9, 0};
  for (int i = 0; i < times; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    const pid_t child = ::fork();
    if (child == 0) {
      run();
      std::_Exit(0);
    }
    int status = 0;
    rusage usage{};
    ::wait4(child, &status, 0, &usage);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    if (status != 0) std::abort();
    best.seconds = std::min(best.seconds, took.count());
    best.peak_mb = std::max(best.peak_mb, static_cast<double>(usage.ru_maxrss) / 1024);
  }
  return best;
}

bool report(const char* what, double value, double target, const char* unit) {
  std::printf("%-58s %9.2f %-10s target %6.1f   %s\n", what, value, unit, target, value >= target ? "met" : "MISSED");
  return value >= target;
}

}  // namespace

int main() {
  std::filesystem::create_directories(folder());
  constexpr int kBlocks = 1'000'000;
  const std::string small = program(kBlocks / 10), large = program(kBlocks);
  const Cost tenth = measure(3, [&] { abbe_program(small); });
  const Cost ours = measure(5, [&] { abbe_program(large); });
  const Cost plain = measure(2, [&] { plain_streams(large); });
  std::printf(
      "1,000,000 five-axis blocks, read, interpreted, written: %.3f s, peak %.1f MB (100,000 blocks: %.1f MB)\n",
      ours.seconds, ours.peak_mb, tenth.peak_mb);
  std::printf("std::getline, istringstream, stod, ostream:             %.3f s\n", plain.seconds);
  if (std::system("command -v rs274 >/dev/null 2>&1") == 0) {
    const Cost reads = measure(1, [&] { linuxcnc(small); });
    std::printf("rs274 reads (and prints) blocks per second:             %.0f\n", kBlocks / 10 / reads.seconds);
  } else {
    std::printf("rs274 is not installed: not compared\n");
  }
  bool met = report("thousand blocks per second", kBlocks / ours.seconds / 1e3, 500, "");
  met = report("times as fast as plain streams", plain.seconds / ours.seconds, 5, "") && met;
  met = report("memory of 100,000 blocks / that of 1,000,000", tenth.peak_mb / ours.peak_mb, 0.9, "") && met;
  std::filesystem::remove_all(folder());
  return met ? 0 : 1;
}
