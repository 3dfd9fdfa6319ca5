#include "abbe/formats/nc/nc_parameters.h"

#include <algorithm>
#include <utility>

namespace abbe {

NcParameters::NcParameters() : values_(kNcParameters), frames_(1) {}

bool NcParameters::is_of_control(int number) {
  return (number >= 5061 && number <= 5070) || number == 5399 || number == 5599;
}

bool NcParameters::get(int number, double& value) const {
  const auto i = static_cast<std::size_t>(number);
  if (number <= kNcLocalParameters) {
    const Frame& frame = frames_.back();
    value = frame.numbered[i];
    return frame.is_set[i];
  }
  if (is_of_system(number) && system_ != nullptr && system_->numbered(number, value)) return true;
  value = values_[i];
  return is_set_[i];
}

bool NcParameters::get(std::string_view name, double& value) const {
  if (!name.empty() && name[0] == '_') {
    if (system_ != nullptr && system_->named(name, value)) return true;
    const auto found = global_.find(name);
    if (found == global_.end()) return false;
    value = found->second;
    return true;
  }
  const auto found = frames_.back().named.find(name);
  if (found == frames_.back().named.end()) return false;
  value = found->second;
  return true;
}

void NcParameters::set(int number, double value) {
  const auto i = static_cast<std::size_t>(number);
  if (number <= kNcLocalParameters) {
    frames_.back().numbered[i] = value;
    frames_.back().is_set[i] = true;
    return;
  }
  values_[i] = value;
  is_set_[i] = true;
}

void NcParameters::set(std::string_view name, double value) {
  auto& names = !name.empty() && name[0] == '_' ? global_ : frames_.back().named;
  const auto found = names.find(name);
  if (found != names.end()) {
    found->second = value;
  } else {
    names.emplace(name, value);
  }
}

void NcParameters::enter(const std::vector<double>& arguments) {
  Frame& frame = frames_.emplace_back();
  frame.is_set.set();
  std::copy_n(arguments.begin(), std::min<std::size_t>(arguments.size(), kNcLocalParameters),
              frame.numbered.begin() + 1);
}

void NcParameters::enter_subprogram() {
  Frame frame = frames_.back();
  frame.named.clear();
  frames_.push_back(std::move(frame));
}

void NcParameters::leave() { frames_.pop_back(); }

void NcParameters::leave_subprogram() {
  Frame& caller = frames_[frames_.size() - 2];
  caller.numbered = frames_.back().numbered;
  caller.is_set = frames_.back().is_set;
  frames_.pop_back();
}

}  // namespace abbe
