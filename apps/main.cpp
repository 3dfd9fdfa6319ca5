#include <CLI/CLI.hpp>

int main(int argc, char** argv) {
  CLI::App app{"abbe: geometric accuracy of multi-axis machines"};
  CLI11_PARSE(app, argc, argv);
  return 0;
}
