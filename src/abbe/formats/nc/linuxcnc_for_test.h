#pragma once

// For tests: LinuxCNC's own interpreter, as the command `rs274` (4 decimals) and as the Python module `gcode`
// (doubles).
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "abbe/compensate/program/program_move.h"
#include "abbe/formats/files/child_process.h"

namespace abbe::test {

/// A move as LinuxCNC's interpreter gives it to the motion part: mm and degrees of the control, offsets added.
struct CanonMove {
  char kind = 0;  ///< T rapid, F straight, A arc, R rigid tapping (there and back)
  std::array<double, 6> end{};
  std::size_t first = 0;           ///< arcs: first axis of the plane (Z X Y: the second one is the next of them)
  std::array<double, 2> centre{};  ///< first and second axis of the plane
  int turns = 0;                   ///< signed
  std::array<double, 3> tool{};    ///< length offset in force, which is in `end`; X, Y, Z, mm
};

struct Canon {
  std::vector<CanonMove> moves;
  std::string error;
};

/// Path of `rs274`, or empty where it is not installed.
inline std::string rs274() {
  const char* const folders = std::getenv("PATH");
  std::istringstream list(folders == nullptr ? "" : folders);
  for (std::string folder; std::getline(list, folder, ':');) {
    const std::filesystem::path path = std::filesystem::path(folder) / "rs274";
    std::error_code ignored;
    if (std::filesystem::exists(path, ignored)) return path.string();
  }
  return "";
}

/// Whether Debian's Python has LinuxCNC's module `gcode`.
inline bool has_gcode_module() {
  static const bool has = [] {
    if (rs274().empty() || !std::filesystem::exists("/usr/bin/python3")) return false;
    const ChildProcess process(
        {"/usr/bin/python3", "-c", "import ctypes, gcode; ctypes.CDLL('libtooldata.so.0')._Z14tool_mmap_userv"}, 60);
    return process.signal() == 0 && process.exit_code() == 0;
  }();
  return has;
}

/// A folder with the program, parameters of zero and two tools; the home folder of what runs there, as LinuxCNC keeps
/// the tools in a file of the home folder, which another one at work would take away.
class LinuxCncFolder {
 public:
  explicit LinuxCncFolder(const std::string& program)
      : path_(std::filesystem::temp_directory_path() / fmt::format("abbe_rs274_{}", ::getpid())) {
    std::filesystem::create_directories(path_);
    std::ofstream(path_ / "program.ngc") << program;
    std::ofstream(path_ / "parameters.var") << "5161\t0\n5181\t0\n5220\t1\n";
    // rs274 takes the lengths of its table for inches.
    std::ofstream(path_ / "tools.tbl") << fmt::format("T1 P1 Z{:.12f}\nT2 P2 X{:.12f} Y{:.12f} Z{:.12f}\n", 50 / 25.4,
                                                      1 / 25.4, 2 / 25.4, 30 / 25.4);
  }
  ~LinuxCncFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  LinuxCncFolder(const LinuxCncFolder&) = delete;
  LinuxCncFolder& operator=(const LinuxCncFolder&) = delete;

  std::string file(const char* name) const { return (path_ / name).string(); }
  std::string home() const { return "HOME=" + path_.string(); }
  std::vector<std::string> rs274_words() const {
    return {"/usr/bin/env",     home(), rs274(), "-g", "-v", file("parameters.var"), "-t", file("tools.tbl"),
            file("program.ngc")};
  }

 private:
  std::filesystem::path path_;
};

inline std::vector<double> numbers_in(const std::string& text) {
  std::vector<double> values;
  const char* at = text.c_str();
  while (*at != 0) {
    char* end = nullptr;
    const double value = std::strtod(at, &end);
    if (end == at) {
      ++at;
    } else {
      values.push_back(value);
      at = end;
    }
  }
  return values;
}

/// Moves of canonical lines: the offsets are added, the unit is mm.
class CanonReader {
 public:
  /// @param name  in capitals, as rs274 prints it
  void line(const std::string& name, const std::string& text) {
    const std::vector<double> v = numbers_in(text);
    if (name == "USE_LENGTH_UNITS") unit_ = text.find("INCHES") != std::string::npos ? 25.4 : 1;
    if (name == "SET_G5X_OFFSET") take(v, 1, system_);
    if (name == "SET_G92_OFFSET") take(v, 0, axis_offset_);
    if (name == "USE_TOOL_LENGTH_OFFSET") take(v, 0, tool_);
    if (name == "SELECT_PLANE") {
      // The module says 1 XY, 2 YZ, 3 XZ.
      const bool zx = text.find("XZ") != std::string::npos || text == "3";
      first_ = zx ? 2 : text.find("YZ") != std::string::npos || text == "2" ? 1 : 0;
    }
    if (name == "STRAIGHT_TRAVERSE" || name == "STRAIGHT_FEED") {
      CanonMove move;
      move.kind = name == "STRAIGHT_FEED" ? 'F' : 'T';
      take(v, 0, move.end);
      give(move);
    } else if (name == "RIGID_TAP") {
      CanonMove move;
      move.kind = 'R';
      move.end = now_;
      for (std::size_t k = 0; k < 3; ++k) {
        move.end[k] = unit_ * v.at(k) + system_[k] + axis_offset_[k] + tool_[k];
        move.tool[k] = tool_[k];
      }
      canon_.moves.push_back(move);
    } else if (name == "ARC_FEED") {
      CanonMove move;
      move.kind = 'A';
      move.first = first_;
      const std::size_t second = (first_ + 1) % 3, normal = (first_ + 2) % 3;
      move.end[first_] = unit_ * v.at(0);
      move.end[second] = unit_ * v.at(1);
      move.end[normal] = unit_ * v.at(5);
      for (std::size_t k = 3; k < 6; ++k) move.end[k] = v.at(k + 3);
      for (std::size_t i = 0; i < 2; ++i) {
        const std::size_t k = (first_ + i) % 3;
        move.centre[i] = unit_ * v.at(2 + i) + system_[k] + axis_offset_[k] + tool_[k];
      }
      move.turns = static_cast<int>(v.at(4));
      give(move);
    }
  }
  void in_inches() { unit_ = 25.4; }
  const Canon& canon() const { return canon_; }

 private:
  void take(const std::vector<double>& v, std::size_t first, std::array<double, 6>& values) const {
    for (std::size_t k = 0; k < 6; ++k) values[k] = k < 3 ? unit_ * v.at(first + k) : v.at(first + k);
  }
  void give(CanonMove& move) {
    bool moves = move.kind == 'A';
    for (std::size_t k = 0; k < 6; ++k) {
      move.end[k] += system_[k] + axis_offset_[k] + tool_[k];
      moves = moves || std::abs(move.end[k] - now_[k]) > 1e-10;
    }
    for (std::size_t k = 0; k < 3; ++k) move.tool[k] = tool_[k];
    // It repeats where it stands between the holes of a cycle.
    if (moves) canon_.moves.push_back(move);
    now_ = move.end;
  }

  Canon canon_;
  double unit_ = 1;
  std::size_t first_ = 0;
  std::array<double, 6> system_{}, axis_offset_{}, tool_{}, now_{};
};

/// The program through `rs274`.
inline Canon run_rs274(const std::string& program) {
  const LinuxCncFolder folder(program);
  const ChildProcess process(folder.rs274_words(), 60);
  const std::string output(process.output());
  CanonReader reader;
  std::istringstream lines(output);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t open = line.find('(');
    const std::size_t blank = line.rfind(' ', open);
    if (open == std::string::npos || blank == std::string::npos) continue;
    reader.line(line.substr(blank + 1, open - blank - 1), line.substr(open + 1));
  }
  Canon canon = reader.canon();
  if (output.find("PROGRAM_END") == std::string::npos && program.find("M2") != std::string::npos)
    canon.error = "rs274 did not reach the end: " + std::string(process.messages()) + output;
  return canon;
}

/// Prints what the module `gcode` calls, with all digits. Its lengths are inches. It finds the tools in the file that
/// rs274 has left in the home folder, once it is told to look there, and asks for their offsets in mm.
inline const char* gcode_script() {
  return R"(
import ctypes, gcode, sys
ctypes.CDLL("libtooldata.so.0")._Z14tool_mmap_userv()
names = {"straight_traverse": "STRAIGHT_TRAVERSE", "straight_feed": "STRAIGHT_FEED", "arc_feed": "ARC_FEED", "rigid_tap": "RIGID_TAP",
         "set_g5x_offset": "SET_G5X_OFFSET", "set_g92_offset": "SET_G92_OFFSET",
         "tool_offset": "USE_TOOL_LENGTH_OFFSET", "set_plane": "SELECT_PLANE"}
class Canon:
    parameter_file = sys.argv[2]
    spindle = 0
    def __getattr__(self, name):
        if name.startswith("__"): raise AttributeError(name)
        def call(*values):
            if name in names: print(names[name], *[repr(v) for v in values])
        return call
    def check_abort(self): return 0
    def get_external_length_units(self): return 1.0
    def get_external_angular_units(self): return 1.0
    def get_axis_mask(self): return 0x3f
    def get_block_delete(self): return 0
    def change_tool(self, number): self.spindle = number
    def get_tool(self, number):
        if number == 0: number = self.spindle
        lengths = {1: (0.0, 0.0, 50.0), 2: (1.0, 2.0, 30.0)}.get(number, (0.0, 0.0, 0.0))
        return (number if number in (0, 1, 2) else -1, *lengths, *[0.0] * 9, 0)
code, line = gcode.parse(sys.argv[1], Canon(), "", "")
print("END" if code <= 1 else "ERROR %s in line %d" % (gcode.strerror(code), line))
)";
}

/// The program through the Python module `gcode`, in full doubles.
inline Canon run_gcode_module(const std::string& program) {
  // What rs274 keeps of the tools is made by a program of one line.
  const LinuxCncFolder folder("M2\n");
  const ChildProcess tools(folder.rs274_words(), 60);
  std::ofstream(folder.file("program.ngc")) << program;
  const ChildProcess process({"/usr/bin/env", folder.home(), "/usr/bin/python3", "-c", gcode_script(),
                              folder.file("program.ngc"), folder.file("parameters.var")},
                             60);
  const std::string output(process.output());
  CanonReader reader;
  reader.in_inches();
  std::istringstream lines(output);
  bool ended = false;
  for (std::string line; std::getline(lines, line);) {
    const std::size_t blank = line.find(' ');
    ended = ended || line == "END";
    if (blank != std::string::npos) reader.line(line.substr(0, blank), line.substr(blank + 1));
  }
  Canon canon = reader.canon();
  if (!ended) canon.error = "the module gcode: " + std::string(process.messages()) + output;
  return canon;
}

/// As moves of the library; feeds are not among them.
inline std::vector<ProgramMove> program_moves(const Canon& canon) {
  constexpr double kToRadians = std::numbers::pi / 180;
  std::vector<ProgramMove> moves;
  WordValues here{};
  for (const CanonMove& c : canon.moves) {
    ProgramMove& move = moves.emplace_back();
    move.start = here;
    for (std::size_t k = 0; k < 6; ++k) move.end[k] = k < 3 ? c.end[k] : c.end[k] * kToRadians;
    here = move.end;
    move.tool_length = c.tool;
    move.kind = c.kind == 'T' ? MoveKind::rapid : MoveKind::straight;
    if (c.kind != 'A') continue;
    move.kind = c.turns < 0 ? MoveKind::arc_clockwise : MoveKind::arc_counterclockwise;
    move.plane = c.first == 0 ? ArcPlane::XY : c.first == 2 ? ArcPlane::ZX : ArcPlane::YZ;
    for (std::size_t i = 0; i < 2; ++i) move.arc_centre[(c.first + i) % 3] = c.centre[i];
    move.arc_turns = std::abs(c.turns);
  }
  return moves;
}

/// The other way round; moves that end where they begin are left out, as CanonReader does.
inline std::vector<CanonMove> canon_moves(const std::vector<ProgramMove>& moves) {
  constexpr double kToDegrees = 180 / std::numbers::pi;
  std::vector<CanonMove> canon;
  for (const ProgramMove& move : moves) {
    const bool is_arc = move.kind == MoveKind::arc_clockwise || move.kind == MoveKind::arc_counterclockwise;
    if (!is_arc && move.start == move.end) continue;
    CanonMove& c = canon.emplace_back();
    c.kind = is_arc ? 'A' : move.kind == MoveKind::rapid ? 'T' : 'F';
    if (move.spindle == SpindleMove::rigid_tapping) c.kind = 'R';
    for (std::size_t k = 0; k < 6; ++k) c.end[k] = k < 3 ? move.end[k] : move.end[k] * kToDegrees;
    if (!is_arc) continue;
    c.first = move.plane == ArcPlane::XY ? 0 : move.plane == ArcPlane::ZX ? 2 : 1;
    c.centre = {move.arc_centre[c.first], move.arc_centre[(c.first + 1) % 3]};
    c.turns = move.kind == MoveKind::arc_clockwise ? -move.arc_turns : move.arc_turns;
  }
  return canon;
}

}  // namespace abbe::test
