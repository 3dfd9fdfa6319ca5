#pragma once

// Internal to formats: the parameters of an NC program.
#include <array>
#include <bitset>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

inline constexpr int kNcParameters = 5602;     ///< numbers from 1 to 5601
inline constexpr int kNcLocalParameters = 30;  ///< #1 to #30 belong to the subroutine that runs

/// What parameters say about the program's own state: #5420, #<_x>, ...
class NcSystemValues {
 public:
  virtual ~NcSystemValues() = default;
  /// @returns whether it is one of those and known
  virtual bool numbered(int number, double& value) const = 0;
  virtual bool named(std::string_view name, double& value) const = 0;
};

/// #1 to #5601, local and global named parameters, and the frames of subroutines.
class NcParameters {
 public:
  NcParameters();

  /// Those of the machine: lengths mm, angles degrees.
  void set_system(const NcSystemValues& system) { system_ = &system; }

  /// @returns whether it has a value here
  bool get(int number, double& value) const;
  bool get(std::string_view name, double& value) const;
  void set(int number, double value);
  void set(std::string_view name, double value);
  /// Results of probing, of inputs and of the control's own state: only it knows them.
  static bool is_of_control(int number);
  /// Offsets and positions, which G10, G92, G28.1 change.
  static bool is_of_system(int number) { return number > 5000; }

  /// Enters a subroutine: its #1 to #30 are the arguments, then zeros.
  void enter(const std::vector<double>& arguments);
  /// Enters a subprogram (M98): it has the numbers of what calls it, and local names of its own.
  void enter_subprogram();
  void leave();
  void leave_subprogram();
  std::size_t depth() const { return frames_.size() - 1; }

 private:
  struct Frame {
    std::array<double, kNcLocalParameters + 1> numbered{};
    std::bitset<kNcLocalParameters + 1> is_set;
    std::map<std::string, double, std::less<>> named;
  };

  std::vector<double> values_;
  std::bitset<kNcParameters> is_set_;
  std::map<std::string, double, std::less<>> global_;
  std::vector<Frame> frames_;
  const NcSystemValues* system_ = nullptr;
};

}  // namespace abbe
