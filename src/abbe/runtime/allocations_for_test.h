#pragma once

namespace abbe::test {

/// How often this program has allocated so far, by operator new of any kind.
long allocations();

}  // namespace abbe::test
