// abbe-step FILE CHORD_MM ANGLE_RAD SECONDS all|leave-out: the faces of a STEP file as triangles on standard output,
// for `abbe` (formats/shapes/step_file.h). CHORD_MM 0: by the size of the shape.
//
// A process of its own, because OpenCASCADE may stop at a damaged file, and because linking it costs every start of
// `abbe` 28 ms. What went wrong on standard error: a line with the problem, perhaps one with what was expected, after
// lines of progress (formats/shapes/step_mesh.h); exit code 0, 2 for a bad file or tolerance, kStepTimeIsUp.
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <Standard_Failure.hxx>
#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <thread>
#include <utility>

#include "abbe/formats/shapes/step_mesh.h"
#include "abbe/formats/text/number_text.h"
#include "failure_words.h"
#include "shape_triangles.h"
#include "step_shape.h"

namespace {

/// A face may take this share of the time.
constexpr double kFaceShare = 1.0 / 3;
/// Without a tolerance of the user's, in parts of the size of the shape: how far a face may be from its triangles where
/// the file's own edges lie beside it.
constexpr double kMostOfSize = 2e-3;

void limit(int what, rlim_t most) {
  struct rlimit now {};
  if (::getrlimit(what, &now) != 0 || now.rlim_cur <= most) return;
  now.rlim_cur = most;
  ::setrlimit(what, &now);
}

void limit_resources(double seconds) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  limit(RLIMIT_CORE, 0);
  // In case nobody ends this process: all processors for twice the time.
  limit(RLIMIT_CPU, static_cast<rlim_t>((2 * seconds + 60) * std::max(1U, std::thread::hardware_concurrency())));
#ifndef ABBE_SANITIZED  // the sanitizer reserves terabytes of addresses
  limit(RLIMIT_AS, rlim_t{8} << 30);
#endif
}

/// Messages may hold names and words of the file or of OpenCASCADE.
std::string on_one_line(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  return text;
}

int fail(int code, const std::string& problem, const std::string& expected = "") {
  std::fprintf(stderr, "%s\n", on_one_line(problem).c_str());
  if (!expected.empty()) std::fprintf(stderr, "%s\n", on_one_line(expected).c_str());
  std::fflush(stderr);
  return code;
}

bool write_all(int file, const std::string& bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const ssize_t written = ::write(file, bytes.data() + done, bytes.size() - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    done += static_cast<std::size_t>(written);
  }
  return true;
}

/// Lines of progress, ten a second at most; for several threads.
class ProgressLines {
 public:
  explicit ProgressLines(const char* what) : what_(what) {}
  void operator()(std::size_t done, std::size_t total) {
    const std::lock_guard lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (done > 0 && now < next_) return;
    next_ = now + std::chrono::milliseconds(100);
    const std::string line = abbe::step_progress_line({what_, done, total}) + "\n";
    std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
  }

 private:
  const char* what_;
  std::mutex mutex_;
  std::chrono::steady_clock::time_point next_{};
};

struct Arguments {
  double chord_mm = 0, angle_rad = 0, seconds = 0;
  bool leave_out_faces = false;
};

int convert(const char* file, const Arguments& arguments, int output) {
  const Handle(abbe::TimeLimit) end = new abbe::TimeLimit(abbe::TimeLimit::after(arguments.seconds));
  ProgressLines("reading")(0, 1);
  abbe::StepShape read = abbe::read_step_shape(file, arguments.leave_out_faces, end);
  const double chord = arguments.chord_mm > 0 ? arguments.chord_mm : abbe::default_step_chord(read.size_mm);
  if (chord < abbe::kFinestStepChord * read.size_mm) {
    return fail(
        2, fmt::format("the shape is {:.3g} mm large, too much for a chord tolerance of {:g} mm", read.size_mm, chord),
        fmt::format("a chord tolerance of at least {:.3g} mm (--chord-mm)", abbe::kFinestStepChord * read.size_mm));
  }
  ProgressLines progress("dividing faces");
  progress(0, 1);
  abbe::ShapeTrianglesOptions options;
  options.division = {chord, arguments.angle_rad, kFaceShare * arguments.seconds, end,
                      [&](std::size_t done, std::size_t total) { progress(done, total); }};
  options.most_mm = arguments.chord_mm > 0 ? chord : std::max(chord, kMostOfSize * read.size_mm);
  options.leave_out_faces = arguments.leave_out_faces;
  abbe::StepMesh mesh = abbe::shape_triangles(read, options);
  mesh.chord_mm = chord;
  mesh.size_mm = read.size_mm;
  mesh.unit = std::move(read.unit);
  mesh.notes.insert(mesh.notes.begin(), read.notes.begin(), read.notes.end());
  return write_all(output, abbe::step_mesh_bytes(mesh)) ? 0 : fail(2, "the triangles could not be written");
}

bool parse(char** arguments, Arguments& parsed) {
  const std::string faces = arguments[5];
  parsed.leave_out_faces = faces == "leave-out";
  return abbe::parse_number(arguments[2], 0, parsed.chord_mm) == abbe::NumberProblem::none &&
         abbe::parse_number(arguments[3], 0, parsed.angle_rad) == abbe::NumberProblem::none &&
         abbe::parse_number(arguments[4], 0, parsed.seconds) == abbe::NumberProblem::none && parsed.chord_mm >= 0 &&
         parsed.angle_rad > 0 && parsed.seconds > 0 && (parsed.leave_out_faces || faces == "all");
}

}  // namespace

int main(int count, char** arguments) {
  Arguments parsed;
  if (count != 6 || !parse(arguments, parsed)) {
    return fail(2, "usage: abbe-step FILE CHORD_MM ANGLE_RAD SECONDS all|leave-out");
  }
  limit_resources(parsed.seconds);
  // Whatever the library prints must not come among the triangles.
  const int output = ::dup(STDOUT_FILENO);
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (output < 0 || nowhere < 0 || ::dup2(nowhere, STDOUT_FILENO) < 0) return fail(2, "there is no output");
  int code = 2;
  try {
    code = convert(arguments[1], parsed, output);
  } catch (const abbe::StepRefused& refused) {
    code = fail(code, refused.what(), refused.expected);
  } catch (const abbe::TimeIsUp&) {
    code = abbe::kStepTimeIsUp;
  } catch (const Standard_Failure& failure) {
    fail(code, "OpenCASCADE: " + abbe::failure_words(failure));
  } catch (const std::bad_alloc&) {
    fail(code, "OpenCASCADE needed more than 8 GiB of memory");
  } catch (const std::exception& error) {
    fail(code, error.what());
  }
  // Its own clean-up at the end takes time and can stop, too.
  ::_exit(code);
}
