// nuno-bench: checks every answer, then says what it costs, here and with every peer.

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <string_view>

#include "sections.h"

namespace nuno::bench {
namespace {

constexpr std::string_view usage =
    "nuno-bench [--quick] [--out DIR] [--scenes DIR]\n"
    "Checks every answer, then prints what it costs as tables and, at the end, as CSV.\n"
    "  --quick       within 60 s instead of minutes\n"
    "  --out DIR     write DIR/bench.json and DIR/bench.csv instead of printing CSV\n"
    "  --scenes DIR  scenes whose minima are checked (default: the project's own)\n"
    "Exit status: 0, or 1 where a result is wrong or cannot be written, or 2 for bad usage.\n";

void write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file(path);
  file << text << std::flush;
  if (!file) throw std::runtime_error(fmt::format("cannot write {}", path.string()));
}

void run(const Options& options) {
  if (!options.output.empty()) std::filesystem::create_directories(options.output);
  const double start = seconds(Clock::wall);
  const Machine machine = describe_machine();
  fmt::print("{}, {} cores, {}, {}; load {:.1f}\n", machine.cpu, machine.cores,
             machine.instruction_set, machine.compiler, machine.load);
  fmt::print("Cells: median (smallest–largest) over repetitions that stand side by side.\n");
  Report report(machine);
  try {
    for (const auto section : {throughput, gradient, threads, optimum, work_precision, long_rollout,
                               sheet_throughput, sheet_optimum, minima}) {
      section(report, options);
    }
  } catch (const Refusal&) {
    report.print_ratios();  // of what was right; nothing is written
    throw;
  }
  report.print_ratios();
  if (options.output.empty()) {
    fmt::print("\n== CSV\n{}", report.csv());
  } else {
    write(std::filesystem::path(options.output) / "bench.json", report.json());
    write(std::filesystem::path(options.output) / "bench.csv", report.csv());
  }
  fmt::print("\n{:.0f} s\n", seconds(Clock::wall) - start);
}

}  // namespace
}  // namespace nuno::bench

int main(int argc, char** argv) {
  nuno::bench::Options options;
  options.scenes = NUNO_SCENES;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--quick") {
      options.quick = true;
    } else if (argument == "--out" && i + 1 < argc) {
      options.output = argv[++i];
    } else if (argument == "--scenes" && i + 1 < argc) {
      options.scenes = argv[++i];
    } else {
      const bool asked = argument == "--help" || argument == "-h";
      fmt::print(asked ? stdout : stderr, "{}", nuno::bench::usage);
      return asked ? 0 : 2;
    }
  }
  try {
    nuno::bench::run(options);
  } catch (const nuno::bench::Refusal& refusal) {
    std::fflush(stdout);
    fmt::print(stderr, "\nnuno-bench: refused: {}\n", refusal.what());
    return 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "nuno-bench: {}\n", error.what());
    return 1;
  }
  return 0;
}
